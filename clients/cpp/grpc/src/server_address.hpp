#pragma once

#include <planemap/client/map_types.hpp>
#include <string>

namespace planemap::client {

/// HOST:PORT in parts.
struct ServerAddress {
  std::string host;  ///< without brackets
  std::string port;

  /// As gRPC takes it.
  std::string text() const;
  /// Whether it names this machine by its loopback.
  bool is_loopback() const;
};

/// From HOST, HOST:PORT, IPv6 or [IPv6]:PORT; the error (kNoNetwork) says what is wrong with it.
Expected<ServerAddress> parse_server_address(const std::string& server);

}  // namespace planemap::client

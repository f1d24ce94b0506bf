#pragma once

#include <cstdint>
#include <planemap/expected.hpp>
#include <string>

namespace planemap::service {

/// Where a server listens.
struct ListenAddress {
  std::string host;        ///< number or name, without brackets
  std::uint16_t port = 0;  ///< 0: any free one

  /// Whether no other machine can reach it. Of names only localhost is: what others mean is for the resolver to say.
  bool is_loopback() const;
};

/// HOST:PORT; an IPv6 number stands in brackets.
Expected<ListenAddress> parse_listen_address(const std::string& text);

/// Whether a number (no name) is one of this machine's loopback: 127.0.0.0/8, ::1, ::ffff:127.0.0.0/104.
bool is_loopback_number(const std::string& host);

}  // namespace planemap::service

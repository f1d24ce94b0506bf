#pragma once

#include <chrono>
#include <memory>
#include <planemap/client/map_types.hpp>
#include <string>

namespace planemap::client {

/// Where planemapd listens unless it is told otherwise.
constexpr const char* kDefaultServer = "127.0.0.1:7670";

/// How a server is spoken to: plainly, unless there is anything for TLS. All are texts, as files hold them, not names
/// of files.
struct GrpcClientOptions {
  bool tls = false;                ///< TLS, by the authorities that this system trusts unless `ca` names others
  std::string ca;                  ///< PEM: the authorities that may sign the server's certificate
  std::string client_certificate;  ///< PEM: shown to servers that ask for one, with its key
  std::string client_key;          ///< PEM
  std::string server_name;         ///< what the server's certificate is for; empty: the host of the address
  std::string token;               ///< sent with each call; over TLS or to the loopback only

  std::chrono::milliseconds heartbeat{1000};     ///< a watch: the server says so often that it lives; 100 ms or more
  std::chrono::milliseconds silent_after{5000};  ///< a watch: nothing was heard for so long: the server is not there
  std::chrono::milliseconds connect_after{200};  ///< a watch that was cut off: so long until it tries again
  std::chrono::milliseconds catch_up_for{2000};  ///< a watch: so long may a snapshot take, if need be beyond a call's
                                                 ///< timeout

  bool has_tls() const { return tls || !ca.empty() || !client_certificate.empty(); }
};

class GrpcChannel;

/// A way to a server, shared by those who ask it. Connects when it is first used, and again when it was cut off.
class GrpcConnection {
 public:
  /// @param server  HOST, HOST:PORT or [IPv6]:PORT; the port is 7670 unless it is given
  /// Fails (kNoNetwork) for an address or options that cannot be used; the error says which and why. Nothing is sent
  /// yet: whether somebody listens shows with the first call.
  static Expected<GrpcConnection> open(const std::string& server, const GrpcClientOptions& options = {});

  const std::shared_ptr<GrpcChannel>& channel() const { return channel_; }

 private:
  explicit GrpcConnection(std::shared_ptr<GrpcChannel> channel) : channel_(std::move(channel)) {}
  std::shared_ptr<GrpcChannel> channel_;
};

}  // namespace planemap::client

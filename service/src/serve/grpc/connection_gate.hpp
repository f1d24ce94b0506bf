#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <planemap/expected.hpp>
#include <string>
#include <thread>
#include <vector>

#include "common/counters.hpp"
#include "common/repeat_guard.hpp"
#include "config/listen_address.hpp"

namespace planemap::service {

/// The sockets that clients connect to. gRPC 1.51 knows no limit of connections, and stops accepting for ever once the
/// process ran out of file descriptors: so connections are accepted here, counted, and handed on. To know when one
/// ends, a second descriptor of each is kept and watched. Those beyond the limit are closed at once, and counted
/// (grpc.connections.refused).
class ConnectionGate {
 public:
  /// Takes over a connected socket.
  using HandOn = std::function<void(int listener, int descriptor)>;

  /// Binds and listens; nothing is accepted before start(). The error names the address and what the system says.
  static Expected<std::unique_ptr<ConnectionGate>> open(const ListenAddress& address, std::size_t max_connections,
                                                        Counters& counters);
  ~ConnectionGate();
  ConnectionGate(const ConnectionGate&) = delete;
  ConnectionGate& operator=(const ConnectionGate&) = delete;

  std::uint16_t port() const { return port_; }
  void start(HandOn hand_on);
  /// Accepts no more; connections that there are go on. The destructor does it, too.
  void stop();

 private:
  ConnectionGate(std::size_t max_connections, Counters& counters);
  Expected<void> listen_on(const ListenAddress& address);
  void run();
  void accept_from(int listener);
  void refuse(const char* kind, const std::string& why);
  void say(const char* kind, const std::string& text);

  const std::size_t max_connections_;
  Counters& counters_;
  std::uint16_t port_ = 0;
  HandOn hand_on_;
  RepeatGuard repeats_;
  std::vector<int> listeners_;    ///< a name may have several numbers
  std::vector<int> connections_;  ///< the second descriptors
  int wake_ = -1;                 ///< eventfd
  int spare_ = -1;                ///< given up to accept and close one when there are no others
  std::thread thread_;
};

}  // namespace planemap::service

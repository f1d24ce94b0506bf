#pragma once

#include <netinet/in.h>

#include <atomic>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

namespace planemap::system_test {

/// LCM on another port of the same group, for those who are to hear through a relay.
extern const char* const kFarLcmUrl;

/// Carries datagrams between the two ports, both ways, and does on the way what networks do: some arrive twice, some
/// later than those behind them.
class Relay {
 public:
  struct Mischief {
    double twice = 0.0;  ///< share of datagrams that arrive twice
    double late = 0.0;   ///< share that lets up to eight others go first
  };

  explicit Relay(const Mischief& mischief);
  ~Relay();
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  std::int64_t carried() const { return carried_; }
  std::int64_t doubled() const { return doubled_; }
  std::int64_t delayed() const { return delayed_; }

 private:
  using Datagram = std::vector<std::uint8_t>;
  struct Held {
    Datagram datagram;
    int others_first = 0;  ///< so many more go before it
  };
  /// One direction.
  struct Way {
    int from = -1;  ///< socket
    std::uint16_t to_port = 0;
    std::vector<Held> held;
  };

  void run(const std::stop_token& stop);
  void carry(Way& way);
  void send(const Way& way, const Datagram& datagram);
  void release(Way& way, bool all);

  Mischief mischief_;
  std::mt19937 random_{5};
  int sender_ = -1;
  std::uint16_t sender_port_ = 0;
  std::vector<Way> ways_;
  std::atomic<std::int64_t> carried_{0};
  std::atomic<std::int64_t> doubled_{0};
  std::atomic<std::int64_t> delayed_{0};
  std::jthread thread_;
};

}  // namespace planemap::system_test

#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <planemap/client/map_client.hpp>
#include <random>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace planemap::system_test {

/// Clients that come, ask, look on for a while and leave, over LCM, gRPC and HTTP, on a thread each. What they do next
/// is drawn from a seed; what the daemon does with it is theirs to complain of.
class Visitors {
 public:
  Visitors(std::string lcm_url, std::string grpc_address, std::uint16_t http_port, unsigned seed);
  ~Visitors();  ///< all leave, in the middle of whatever they do

  /// How often each kind of client has come so far.
  std::map<std::string, std::int64_t> visits() const;
  /// What they were answered instead of what they asked for; the first hundred.
  std::vector<std::string> complaints() const;

 private:
  using Random = std::mt19937;

  void come(const std::string& kind, unsigned seed, const std::function<void(Random&, const std::stop_token&)>& visit);
  void ask_over_lcm(Random& random, const std::stop_token& stop);
  void ask_over_grpc(Random& random, const std::stop_token& stop);
  void ask(client::MapClient& client, Random& random, const std::stop_token& stop);
  void browse(Random& random, const std::stop_token& stop);

  const std::string lcm_url_;
  const std::string grpc_address_;
  const std::uint16_t http_port_;
  mutable std::mutex mutex_;
  std::map<std::string, std::int64_t> visits_;
  std::vector<std::string> complaints_;
  std::vector<std::jthread> threads_;  ///< last: they use the others
};

}  // namespace planemap::system_test

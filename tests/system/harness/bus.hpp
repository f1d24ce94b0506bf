#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <optional>
#include <planemap_lcm/status_t.hpp>
#include <string>
#include <vector>

namespace planemap::system_test {

/// The test's own ear and mouth on LCM. One thread: it hears while it waits.
class Bus {
 public:
  Bus();

  lcm::LCM& lcm() { return lcm_; }

  /// The newest status that was published; empty: none yet.
  const std::optional<planemap_lcm::status_t>& status() const { return status_; }
  /// A counter of the newest status; 0 where there is no such counter or no status.
  std::int64_t counter(const std::string& name) const;
  /// The sum of the counters whose names begin so.
  std::int64_t counters_beginning(const std::string& prefix) const;
  /// All counters, a line each: for the messages of failing tests.
  std::string describe() const;

  /// Listens until the condition holds or the time is up. The condition is looked at after each message, and every 20
  /// ms.
  /// @return whether it held
  bool wait_until(const std::function<bool()>& condition, std::chrono::milliseconds limit);
  /// Listens for so long.
  void listen_for(std::chrono::milliseconds time);

 private:
  void on_status(const lcm::ReceiveBuffer* buffer, const std::string& channel, const planemap_lcm::status_t* status);

  lcm::LCM lcm_;
  std::optional<planemap_lcm::status_t> status_;
};

}  // namespace planemap::system_test

#pragma once

#include <algorithm>
#include <chrono>
#include <planemap/client/map_types.hpp>
#include <string>
#include <utility>

namespace planemap::client {

/// The time for a call that asks more than once.
class Deadline {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Deadline(std::chrono::milliseconds timeout) : timeout_(timeout), end_(Clock::now() + timeout) {}
  std::chrono::milliseconds timeout() const { return timeout_; }
  std::chrono::milliseconds left() const {
    return std::max(std::chrono::milliseconds(0),
                    std::chrono::duration_cast<std::chrono::milliseconds>(end_ - Clock::now()));
  }
  bool is_over() const { return left() == std::chrono::milliseconds(0); }

 private:
  std::chrono::milliseconds timeout_;
  Clock::time_point end_;
};

/// "1.5 s"
std::string seconds_text(std::chrono::milliseconds time);

/// Time was up before all of an answer was there.
inline tl::unexpected<Error> incomplete(const std::string& what, std::chrono::milliseconds timeout) {
  return tl::make_unexpected(Error{Error::Kind::kIncomplete, what + " within " + seconds_text(timeout)});
}

}  // namespace planemap::client

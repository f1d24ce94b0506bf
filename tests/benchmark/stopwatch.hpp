#pragma once

#include <chrono>

namespace planemap::benchmark {

class Stopwatch {
 public:
  void restart() { begin_ = Clock::now(); }
  /// Since the start or restart.
  double ms() const { return std::chrono::duration<double, std::milli>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace planemap::benchmark

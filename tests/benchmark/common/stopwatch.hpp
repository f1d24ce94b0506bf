#pragma once

#include <chrono>
#include <ctime>

namespace planemap::benchmark {

/// By the clock, and by the calling thread's own time: a busy machine does not lengthen the latter, but for what others
/// do to its caches.
class Stopwatch {
 public:
  void restart() { *this = Stopwatch(); }
  /// Since the start or restart.
  double ms() const { return std::chrono::duration<double, std::milli>(Clock::now() - begin_).count(); }
  double own_ms() const { return own_now_ms() - own_begin_ms_; }

 private:
  using Clock = std::chrono::steady_clock;
  static double own_now_ms() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  }

  double own_begin_ms_ = own_now_ms();
  Clock::time_point begin_ = Clock::now();
};

}  // namespace planemap::benchmark

#pragma once

#include <ctime>

namespace planemap::benchmark {

/// Processor time of the calling thread: other programs on the machine take none of it, though they do take its caches.
class Stopwatch {
 public:
  void restart() { begin_ms_ = now_ms(); }
  /// Since the start or restart.
  double ms() const { return now_ms() - begin_ms_; }

 private:
  static double now_ms() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
  }
  double begin_ms_ = now_ms();
};

}  // namespace planemap::benchmark

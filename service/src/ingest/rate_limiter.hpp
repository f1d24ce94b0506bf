#pragma once

#include <cstdint>

namespace planemap::service {

/// Thins a stream to a rate, by the messages' own time.
class RateLimiter {
 public:
  /// @param max_rate_hz  0: no limit
  /// @param restart_s    a step back in time by more is a restart of the clock
  RateLimiter(double max_rate_hz, double restart_s);

  /// Whether the scan of that time may pass. Over a long time the rate is kept exactly, though single intervals may be
  /// a tenth shorter: without this slack a sensor of twice the rate, with jitter, would be thinned to a third.
  bool passes(std::int64_t utime);

 private:
  double period_us_;
  double restart_us_;
  double next_us_ = 0.0;
  double newest_us_ = 0.0;  ///< passed or not
  bool started_ = false;
};

}  // namespace planemap::service

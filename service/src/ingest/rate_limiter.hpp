#pragma once

#include <cstdint>

namespace planemap::service {

/// Thins a stream to a rate, by the messages' own time.
class RateLimiter {
 public:
  /// @param max_rate_hz  0: no limit
  explicit RateLimiter(double max_rate_hz);

  /// Whether the scan of that time may pass. Over a long time the rate is kept exactly, though single intervals may be
  /// a tenth shorter: without this slack a sensor of twice the rate, with jitter, would be thinned to a third.
  bool passes(std::int64_t utime);

 private:
  double period_us_;
  double next_us_ = 0.0;
  bool started_ = false;
};

}  // namespace planemap::service

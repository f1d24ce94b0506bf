#include "ingest/rate_limiter.hpp"

#include <algorithm>

namespace planemap::service {

RateLimiter::RateLimiter(double max_rate_hz, double restart_s)
    : period_us_(max_rate_hz > 0.0 ? 1e6 / max_rate_hz : 0.0), restart_us_(1e6 * restart_s) {}

bool RateLimiter::passes(std::int64_t utime) {
  if (period_us_ == 0.0) return true;
  const auto now_us = static_cast<double>(utime);
  // A clock that stepped back must not silence the sensor until it has caught up.
  if (!started_ || now_us < newest_us_ - restart_us_ || now_us < next_us_ - 2.0 * period_us_) {
    started_ = true;
    newest_us_ = now_us;
    next_us_ = now_us + period_us_;
    return true;
  }
  newest_us_ = std::max(newest_us_, now_us);
  if (now_us < next_us_ - 0.1 * period_us_) return false;
  next_us_ = std::max(next_us_, now_us - period_us_) + period_us_;
  return true;
}

}  // namespace planemap::service

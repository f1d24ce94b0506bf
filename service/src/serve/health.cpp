#include "serve/health.hpp"

#include <spdlog/fmt/fmt.h>

namespace planemap::service {

Health::Health(const MappingService& mapping, double stuck_after_s)
    : mapping_(mapping), stuck_after_s_(stuck_after_s) {}

HealthReport Health::liveness(double now_host_s) const {
  const auto busy_since_host_s = mapping_.stats(now_host_s).busy_since_host_s;
  if (!busy_since_host_s || now_host_s - *busy_since_host_s < stuck_after_s_) return {};
  return {false, fmt::format("the mapper has been at one scan for {:.1f} s", now_host_s - *busy_since_host_s)};
}

HealthReport Health::readiness(double now_host_s) const {
  switch (state_.load()) {
    case State::kStarting:
      return {false, "planemapd is starting"};
    case State::kEnding:
      return {false, "planemapd is ending"};
    case State::kServing:
      break;
  }
  return liveness(now_host_s);
}

}  // namespace planemap::service

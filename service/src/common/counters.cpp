#include "common/counters.hpp"

#include <cassert>

namespace planemap::service {

Counters::Counters() : values_{{"scans.received", 0}, {"scans.mapped", 0}, {"scans.waiting", 0}} {}

void Counters::scan_received() {
  const std::lock_guard lock(mutex_);
  ++count_of("scans.received");
  ++count_of("scans.waiting");
}

std::int64_t& Counters::count_of(std::string_view name) {
  const auto found = values_.find(name);
  return found != values_.end() ? found->second : values_[std::string(name)];
}

void Counters::scan_leaves(std::string_view name) {
  auto& waiting = count_of("scans.waiting");
  assert(waiting > 0 && "a scan left that was never received");
  --waiting;
  ++count_of(name);
}

void Counters::scan_mapped(const PointCounts& points) {
  const std::lock_guard lock(mutex_);
  scan_leaves("scans.mapped");
  count_of("points.total") += static_cast<std::int64_t>(points.total);
  count_of("points.mapped") += static_cast<std::int64_t>(points.mapped);
  count_of("points.no_return") += static_cast<std::int64_t>(points.no_return);
  count_of("points.out_of_range") += static_cast<std::int64_t>(points.out_of_range);
  count_of("points.invalid") += static_cast<std::int64_t>(points.invalid);
}

void Counters::scan_dropped(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  scan_leaves("scans.dropped." + reason);
}

void Counters::scan_rejected(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  scan_leaves("scans.rejected." + reason);
}

void Counters::add(const std::string& name, std::int64_t by) {
  const std::lock_guard lock(mutex_);
  count_of(name) += by;
}

void Counters::set(const std::string& name, std::int64_t value) {
  const std::lock_guard lock(mutex_);
  count_of(name) = value;
}

CounterValues Counters::values() const {
  const std::lock_guard lock(mutex_);
  return {values_.begin(), values_.end()};
}

std::int64_t Counters::value(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = values_.find(name);
  return found == values_.end() ? 0 : found->second;
}

}  // namespace planemap::service

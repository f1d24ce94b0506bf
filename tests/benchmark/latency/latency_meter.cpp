#include "latency/latency_meter.hpp"

#include <algorithm>

namespace planemap::benchmark {

void LatencyMeter::page_arrived(std::int64_t utime, std::int64_t revision, int page, int page_count,
                                std::int64_t arrival_us) {
  std::set<int>& pages = pages_[revision];
  pages.insert(page);
  if (pages.size() < static_cast<std::size_t>(std::max(1, page_count))) return;
  pages_.erase(revision);
  deltas_.emplace(utime, arrival_us);
}

bool LatencyMeter::is_up_to_date() const {
  return scans_.empty() || deltas_.lower_bound(scans_.rbegin()->first) != deltas_.end();
}

std::vector<ScanLatency> LatencyMeter::latencies() const {
  std::vector<ScanLatency> all;
  all.reserve(scans_.size());
  for (const auto& [utime, arrival_us] : scans_) {
    const auto pose = poses_.lower_bound(utime);
    const auto delta = deltas_.lower_bound(utime);
    if (pose == poses_.end() || delta == deltas_.end()) continue;
    const std::int64_t begin_us = std::max(arrival_us, pose->second);
    all.push_back({utime, 1e-3 * static_cast<double>(begin_us - arrival_us),
                   1e-3 * static_cast<double>(delta->second - begin_us), delta->first == utime});
  }
  return all;
}

}  // namespace planemap::benchmark

#include "serve/status_board.hpp"

#include <spdlog/spdlog.h>

#include "common/version.hpp"

namespace planemap::service {
namespace {

constexpr double kLogPeriodS = 5.0;

/// Sum of the counters whose names begin so.
std::int64_t sum_of(const CounterValues& values, const std::string& prefix) {
  std::int64_t sum = 0;
  for (auto entry = values.lower_bound(prefix); entry != values.end() && entry->first.rfind(prefix, 0) == 0; ++entry) {
    sum += entry->second;
  }
  return sum;
}

}  // namespace

StatusBoard::StatusBoard(const ScanIntake& intake, const MappingService& mapping, Counters& counters)
    : intake_(intake), mapping_(mapping), counters_(counters), repeats_(kLogPeriodS), started_host_s_(steady_now_s()) {}

std::string StatusBoard::idle_reason_at(double now_host_s) const {
  const MappingStats stats = mapping_.stats(now_host_s);
  const MapperFacts mapper{stats.mapped,
                           stats.last_mapped_host_s,
                           stats.queued,
                           stats.queue_capacity,
                           stats.busy_since_host_s,
                           stats.dropped_from_full_queue,
                           stats.last_dropped_host_s,
                           stats.last_error,
                           stats.last_error_host_s,
                           stats.is_paused,
                           stats.reset_host_s};
  return idle_reason(intake_.facts(), mapper, now_host_s);
}

planemap_lcm::status_t StatusBoard::status(double now_host_s, std::int64_t utime) {
  const auto snapshot = mapping_.snapshot();
  const MappingStats stats = mapping_.stats(now_host_s);
  planemap_lcm::status_t status{};
  status.utime = utime;
  status.version = version();
  status.epoch = static_cast<std::int64_t>(snapshot->epoch());
  status.revision = static_cast<std::int64_t>(snapshot->revision());
  status.plane_count = static_cast<std::int64_t>(snapshot->planes().size());
  status.cell_count = static_cast<std::int64_t>(snapshot->cell_count());
  status.block_count = static_cast<std::int64_t>(snapshot->block_count());
  status.scan_rate_hz = stats.rate_hz;
  status.scan_ms_p50 = stats.scan_ms_p50;
  status.scan_ms_max = stats.scan_ms_max;
  status.last_scan_utime = stats.last_scan_utime;
  status.idle_reason = idle_reason_at(now_host_s);
  status.degraded = mapping_.keeper_problem();
  counters_.set("lcm.kernel_drops", kernel_drops_.count());
  for (const auto& [name, value] : counters_.values()) {
    planemap_lcm::counter_t counter{};
    counter.name = name;
    counter.value = value;
    status.counters.push_back(std::move(counter));
  }
  status.n_counters = static_cast<std::int32_t>(status.counters.size());
  return status;
}

void StatusBoard::log(double now_host_s) {
  if (now_host_s - started_host_s_ < kIdleAfterS) return;  // a start is not idle
  const std::string reason = idle_reason_at(now_host_s);
  if (!reason.empty()) {
    if (repeats_.pass("idle", now_host_s) > 0) spdlog::warn("nothing is being mapped: {}", reason);
    return;
  }
  if (repeats_.pass("progress", now_host_s) == 0) return;
  const auto snapshot = mapping_.snapshot();
  const MappingStats stats = mapping_.stats(now_host_s);
  const CounterValues values = counters_.values();
  spdlog::info("{} scans mapped ({:.0f}/s, {:.1f} ms each), {} dropped, {} rejected; {} planes, {} cells, revision {}",
               stats.mapped, stats.rate_hz, stats.scan_ms_p50, sum_of(values, "scans.dropped."),
               sum_of(values, "scans.rejected."), snapshot->planes().size(), snapshot->cell_count(),
               snapshot->revision());
}

}  // namespace planemap::service

#include "mapping/mapping_service.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>
#include <vector>

#include "mapping/stage_times.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kTimedScans = 100;
constexpr double kRateWindowS = 1.0;

}  // namespace

double steady_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

MappingService::MappingService(const ServiceConfig& config, std::uint64_t epoch, Counters& counters,
                               std::function<void()> on_snapshot)
    : counters_(counters),
      on_snapshot_(std::move(on_snapshot)),
      queue_(static_cast<std::size_t>(config.queue.scans)),
      mapper_(config.mapper, epoch),
      snapshot_(mapper_.snapshot()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

MappingService::~MappingService() {
  stop();
}

void MappingService::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  for (std::size_t left = queue_.clear(); left > 0; --left) counters_.scan_dropped("shutdown");
}

void MappingService::push(RegisteredScan&& scan) {
  for (std::size_t dropped = queue_.push_dropping_oldest(std::move(scan)); dropped > 0; --dropped) {
    counters_.scan_dropped("queue_full");
  }
}

void MappingService::run(const std::stop_token& stop) {
  while (auto scan = queue_.pop(stop)) {
    try {
      map(*scan);
    } catch (const std::exception& e) {
      counters_.scan_dropped("mapper_error");
      spdlog::error("the scan at utime {} could not be mapped: {}", utime_of(scan->scan), e.what());
    }
  }
}

void MappingService::map(const RegisteredScan& scan) {
  StageTimer timer;
  const double begin_s = steady_now_s();
  const ScanReport report = mapper_.integrate(scan.scan, scan.T_world_sensor, &timer);
  auto snapshot = mapper_.snapshot(&timer);
  const double end_s = steady_now_s();
  {
    const std::lock_guard lock(mutex_);
    snapshot_.swap(snapshot);
    ++stats_.mapped;
    stats_.last_scan_utime = utime_of(scan.scan);
    stats_.last_mapped_host_s = end_s;
    scan_ms_.push_back(1e3 * (end_s - begin_s));
    if (scan_ms_.size() > kTimedScans) scan_ms_.pop_front();
    mapped_at_host_s_.push_back(end_s);
    while (mapped_at_host_s_.front() < end_s - kRateWindowS) mapped_at_host_s_.pop_front();
  }
  counters_.scan_mapped(report.points);
  const auto& ms = timer.ms();
  spdlog::trace(
      "scan {}: {} points, {} cells, {:.2f} ms (assign {:.2f}, normals {:.2f}, local {:.2f}, global {:.2f}, "
      "snapshot {:.2f})",
      utime_of(scan.scan), report.points.mapped, report.touched_cells, 1e3 * (end_s - begin_s), ms[0], ms[1], ms[2],
      ms[3], ms[4]);
  if (on_snapshot_) on_snapshot_();
}

std::shared_ptr<const MapSnapshot> MappingService::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

MappingStats MappingService::stats(double now_host_s) const {
  std::vector<double> times;
  MappingStats stats;
  {
    const std::lock_guard lock(mutex_);
    stats = stats_;
    times.assign(scan_ms_.begin(), scan_ms_.end());
    stats.rate_hz = static_cast<double>(std::count_if(mapped_at_host_s_.begin(), mapped_at_host_s_.end(),
                                                      [&](double at_s) { return at_s >= now_host_s - kRateWindowS; })) /
                    kRateWindowS;
  }
  if (times.empty()) return stats;
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  stats.scan_ms_p50 = *middle;
  stats.scan_ms_max = *std::max_element(times.begin(), times.end());
  return stats;
}

}  // namespace planemap::service

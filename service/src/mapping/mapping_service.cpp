#include "mapping/mapping_service.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mapping/stage_times.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kTimedScans = 100;
constexpr double kRateWindowS = 1.0;
constexpr double kWarnPeriodS = 5.0;

Mapper first_mapper(const MapperConfig& config, std::uint64_t epoch, const MapSnapshot* initial, SecondThread* second) {
  if (initial == nullptr) return {config, epoch, second};
  auto mapper = Mapper::restore(config, *initial, second);
  if (!mapper) throw std::runtime_error("the map cannot be gone on with: " + mapper.error().message);
  return std::move(*mapper);
}

}  // namespace

double steady_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

MappingService::MappingService(const ServiceConfig& config, std::uint64_t epoch, Counters& counters,
                               std::function<void()> on_snapshot, const MapSnapshot* initial)
    : config_(config.mapper),
      first_epoch_(initial == nullptr ? epoch : std::max(epoch, initial->epoch())),
      counters_(counters),
      on_snapshot_(std::move(on_snapshot)),
      queue_(static_cast<std::size_t>(config.queue.scans)),
      helper_(helper_thread_for(config.mapping.threads)),
      mapper_(first_mapper(config_, epoch, initial, helper_.get())),
      repeats_(kWarnPeriodS),
      snapshot_(mapper_.snapshot()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

MappingService::~MappingService() {
  stop();
}

void MappingService::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  drop_waiting("shutdown");
}

void MappingService::drop_waiting(const char* reason) {
  for (std::size_t left = queue_.clear(); left > 0; --left) counters_.scan_dropped(reason);
}

void MappingService::push(RegisteredScan&& scan) {
  if (is_paused()) return counters_.scan_dropped("paused");
  if (queue_.push_dropping_oldest(std::move(scan)) == 0) return;
  counters_.scan_dropped("queue_full");
  const std::lock_guard lock(mutex_);
  ++stats_.dropped_from_full_queue;
  stats_.last_dropped_host_s = steady_now_s();
}

void MappingService::pause() {
  {
    const std::lock_guard lock(mutex_);
    stats_.is_paused = true;
  }
  drop_waiting("paused");
}

bool MappingService::is_paused() const {
  const std::lock_guard lock(mutex_);
  return stats_.is_paused;
}

void MappingService::resume() {
  const std::lock_guard lock(mutex_);
  stats_.is_paused = false;
}

std::optional<std::uint64_t> MappingService::reset(std::chrono::steady_clock::duration timeout) {
  drop_waiting("reset");
  std::unique_lock lock(mutex_);
  const std::uint64_t number = ++asked_resets_;
  queue_.interrupt();
  if (!reset_done_.wait_for(lock, timeout, [&] { return done_resets_ >= number; })) return std::nullopt;
  return snapshot_->epoch();
}

void MappingService::set_keeper(MapKeeper* keeper) {
  const std::unique_lock lock(keeper_mutex_);
  keeper_ = keeper;
}

bool MappingService::has_keeper() const {
  const std::shared_lock lock(keeper_mutex_);
  return keeper_ != nullptr;
}

Expected<void> MappingService::save(std::chrono::steady_clock::duration timeout) {
  const std::shared_lock lock(keeper_mutex_);
  if (keeper_ == nullptr) return fail("the map has no file: planemapd --map FILE, or store.path, gives it one");
  return keeper_->save(timeout);
}

std::string MappingService::keeper_problem() const {
  const std::shared_lock lock(keeper_mutex_);
  return keeper_ == nullptr ? std::string() : keeper_->problem();
}

/// On the mapper's thread. Unlike after a jump of the pose, readers get the new map at once, though it is empty.
void MappingService::begin_asked_maps() {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    if (asked_resets_ == done_resets_) return;
    number = asked_resets_;
  }
  resets_ += number - done_resets_;
  const std::uint64_t epoch = first_epoch_ + map_number_ + resets_;
  const auto old = snapshot();
  mapper_ = Mapper(config_, epoch, helper_.get());
  counters_.add("map.resets");
  publish(mapper_.snapshot());
  spdlog::info("a new map begins on demand, epoch {}; that of epoch {} had {} planes, revision {}", epoch, old->epoch(),
               old->planes().size(), old->revision());
  {
    const std::lock_guard lock(mutex_);
    done_resets_ = number;
    stats_.reset_host_s = steady_now_s();
  }
  reset_done_.notify_all();
  if (on_snapshot_) on_snapshot_();
}

void MappingService::publish(std::shared_ptr<const MapSnapshot> snapshot) {
  const std::lock_guard lock(mutex_);
  snapshot_.swap(snapshot);
}

void MappingService::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    begin_asked_maps();
    const auto scan = queue_.pop(stop);
    if (!scan) continue;
    if (is_paused()) {  // it came while pause() emptied the queue
      counters_.scan_dropped("paused");
      continue;
    }
    note_busy(steady_now_s());
    bool is_mapped = false;
    try {
      map(*scan);
      is_mapped = true;
    } catch (const std::exception& e) {
      counters_.scan_dropped("mapper_error");
      note_error(fmt::format("the scan at utime {} could not be mapped: {}", utime_of(scan->scan), e.what()));
    }
    note_busy(std::nullopt);
    if (is_mapped && on_snapshot_) on_snapshot_();
  }
}

void MappingService::note_busy(std::optional<double> since_host_s) {
  const std::lock_guard lock(mutex_);
  stats_.busy_since_host_s = since_host_s;
}

void MappingService::note_error(std::string error) {
  const int count = repeats_.pass("error", steady_now_s());
  if (count > 0) spdlog::error("{}{}", error, repeats_text(count));
  const std::lock_guard lock(mutex_);
  stats_.last_error = std::move(error);
  stats_.last_error_host_s = steady_now_s();
}

/// Readers keep the old map until the first scan of the new one is in it.
void MappingService::begin_new_map(std::uint64_t map_number) {
  const std::uint64_t epoch = first_epoch_ + map_number + resets_;
  mapper_ = Mapper(config_, epoch, helper_.get());
  map_number_ = map_number;
  counters_.add("map.resets");
  const int count = repeats_.pass("reset", steady_now_s());
  if (count == 0) return;
  const auto old = snapshot();
  spdlog::warn("the pose jumped: a new map begins, epoch {}; that of epoch {} had {} planes, revision {}{}", epoch,
               old->epoch(), old->planes().size(), old->revision(), repeats_text(count));
}

void MappingService::map(const RegisteredScan& scan) {
  StageTimer timer;
  const double begin_s = steady_now_s();
  if (scan.map_number > map_number_) begin_new_map(scan.map_number);
  const ScanReport report = mapper_.integrate(scan.scan, scan.T_world_sensor, &timer, scan.pose_covariance);
  auto snapshot = mapper_.snapshot(&timer);
  const double end_s = steady_now_s();
  {
    const std::lock_guard lock(mutex_);
    snapshot_.swap(snapshot);
    ++stats_.mapped;
    stats_.last_scan_utime = utime_of(scan.scan);
    stats_.last_mapped_host_s = end_s;
    scan_ms_.push_back(1e3 * (end_s - begin_s));
    if (scan_ms_.size() > kTimedScans) scan_ms_.erase(scan_ms_.begin());
    mapped_at_host_s_.push_back(end_s);
    std::erase_if(mapped_at_host_s_, [&](double at_s) { return at_s < end_s - kRateWindowS; });
  }
  const auto& ms = timer.ms();
  {
    const std::lock_guard lock(listener_mutex_);
    if (scan_listener_) scan_listener_({scan, first_epoch_ + map_number_ + resets_, ms, 1e3 * (end_s - begin_s)});
  }
  counters_.add("cells.worn", static_cast<std::int64_t>(report.worn_cells));
  counters_.scan_mapped(report.points);  // last: whoever sees it counted finds it everywhere
  spdlog::trace(
      "scan {}: {} points, {} cells, {:.2f} ms (assign {:.2f}, normals {:.2f}, local {:.2f}, global {:.2f}, "
      "wear {:.2f}, snapshot {:.2f})",
      utime_of(scan.scan), report.points.mapped, report.touched_cells, 1e3 * (end_s - begin_s), ms[0], ms[1], ms[2],
      ms[3], ms[4], ms[5]);
}

void MappingService::set_scan_listener(std::function<void(const MappedScan&)> listener) {
  const std::lock_guard lock(listener_mutex_);
  scan_listener_ = std::move(listener);
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
    stats.queued = queue_.size();
    stats.queue_capacity = queue_.capacity();
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

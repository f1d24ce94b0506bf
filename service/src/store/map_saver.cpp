#include "store/map_saver.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "common/background.hpp"

namespace planemap::service {
namespace {

constexpr double kWarnPeriodS = 30.0;
constexpr double kFirstBackupsS = 15.0;
constexpr int kNice = 5;  ///< the mapper goes first

std::chrono::steady_clock::duration seconds(double s) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(s));
}

}  // namespace

MapSaver::MapSaver(const StoreConfig& config, MapStore store, MappingService& mapping, Counters& counters)
    : config_(config),
      mapping_(mapping),
      counters_(counters),
      backups_(store.path, counters),
      store_(std::move(store)),
      repeats_(kWarnPeriodS),
      next_backup_(std::chrono::steady_clock::now()),
      backup_wait_s_(std::min(config.backup_s, kFirstBackupsS)) {
  note(store_.problem);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

MapSaver::~MapSaver() {
  stop();
}

void MapSaver::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void MapSaver::run(const std::stop_token& stop) {
  run_in_background(kNice);
  auto next = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    next += seconds(config_.interval_s);  // from begin to begin: else what a commit takes came on top of the interval
    std::uint64_t asked = 0;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_until(lock, stop, next, [&] { return asked_saves_ != done_saves_; });
      asked = asked_saves_;
    }
    if (stop.stop_requested()) break;
    next = std::chrono::steady_clock::now();
    commit(false);
    note_time(std::chrono::steady_clock::now() - next);
    back_up_if_due();
    {
      const std::lock_guard lock(mutex_);
      done_saves_ = asked;
    }
    changed_.notify_all();
  }
  backups_.stop();
  commit(true);
}

void MapSaver::commit(bool closing) {
  const auto map = mapping_.snapshot();
  if (!closing && store_.file && store_.file->committed() == map) return;
  const auto before = store_.file ? store_.file->committed() : nullptr;
  StoreExpected<std::size_t> written;
  try {
    written = write(map, closing);
  } catch (const std::exception& error) {
    written = tl::make_unexpected(StoreError{StoreError::Kind::kSystem, error.what()});
  }
  if (!written) {
    counters_.add("store.failures");
    note(written.error().message);
    return;
  }
  // After a reset the backup is no longer a map that anybody wants back.
  if (before && before->epoch() != map->epoch()) next_backup_ = std::chrono::steady_clock::now();
  counters_.add("store.commits");
  counters_.add("store.rows", static_cast<std::int64_t>(*written));
  note({});
}

StoreExpected<std::size_t> MapSaver::write(const std::shared_ptr<const MapSnapshot>& map, bool closing) {
  if (!store_.file) {  // at the start there was no way to make it
    std::error_code ignored;
    if (std::filesystem::exists(store_.path, ignored)) {
      return tl::make_unexpected(
          StoreError{StoreError::Kind::kOther,
                     store_.path.string() + ": a file has come that is not this map's; it is left alone"});
    }
    auto file = MapFile::create(store_.path, store_.facts);
    if (!file) return tl::make_unexpected(file.error());
    store_.file = std::make_unique<MapFile>(std::move(*file));
  }
  return closing ? store_.file->close(map) : store_.file->commit(map);
}

/// Only of what could be committed: a disk that is full has no room for a backup either.
void MapSaver::back_up_if_due() {
  if (config_.backup_s <= 0.0 || !store_.file || !problem().empty()) return;
  if (std::chrono::steady_clock::now() < next_backup_) return;
  next_backup_ = std::chrono::steady_clock::now() + seconds(backup_wait_s_);
  backup_wait_s_ = std::min(config_.backup_s, 2.0 * backup_wait_s_);
  backups_.begin();
}

/// What is promised of a kill is of a disk that takes a commit within the interval.
void MapSaver::note_time(std::chrono::steady_clock::duration taken) {
  if (taken <= seconds(config_.interval_s)) return;
  counters_.add("store.late_commits");
  const int count = repeats_.pass("late", steady_now_s());
  if (count > 0) {
    spdlog::warn(
        "{}: a commit took {:.1f} s, longer than store.interval_s: so much more of the map is lost if the "
        "process is killed{}",
        store_.path.string(), std::chrono::duration<double>(taken).count(), repeats_text(count));
  }
}

/// @param problem  empty: all is well
void MapSaver::note(std::string problem) {
  counters_.set("store.degraded", problem.empty() ? 0 : 1);
  {
    const std::lock_guard lock(mutex_);
    const bool was_bad = !problem_.empty();
    problem_ = problem;
    if (problem.empty()) {
      if (was_bad) spdlog::info("{}: the map is saved again", store_.path.string());
      return;
    }
  }
  const int count = repeats_.pass("save", steady_now_s());
  if (count > 0) spdlog::error("{}; mapping goes on, the map is not being kept{}", problem, repeats_text(count));
}

Expected<void> MapSaver::save(std::chrono::steady_clock::duration timeout) {
  std::unique_lock lock(mutex_);
  const std::uint64_t number = ++asked_saves_;
  changed_.notify_all();
  if (!changed_.wait_for(lock, timeout, [&] { return done_saves_ >= number; })) {
    return fail("the disk did not take the map in time; it is tried on");
  }
  if (!problem_.empty()) return fail(problem_);
  return {};
}

std::string MapSaver::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

}  // namespace planemap::service

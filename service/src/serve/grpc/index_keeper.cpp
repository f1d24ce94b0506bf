#include "serve/grpc/index_keeper.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "config/map_gravity.hpp"

namespace planemap::service {

IndexKeeper::IndexKeeper(const ServiceConfig& config, const MappingService& mapping, OnIndex on_index, double kept_s)
    : mapping_(mapping),
      gravity_(gravity_of(config.map)),
      index_age_s_(config.grpc.index_age_s),
      watch_period_s_(config.grpc.watch_period_s),
      on_index_(std::move(on_index)),
      kept_s_(kept_s) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

IndexKeeper::~IndexKeeper() {
  stop();
}

void IndexKeeper::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  built_.notify_all();
}

void IndexKeeper::keep(const std::shared_ptr<const MapIndex>& index) {
  const std::lock_guard lock(mutex_);
  keep_locked(index, steady_now_s());
}

std::shared_ptr<const MapIndex> IndexKeeper::of_version(std::uint64_t epoch, std::uint64_t revision,
                                                        std::int64_t utime) {
  if (mapping_.snapshot()->epoch() != epoch) return nullptr;
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    const MapSnapshot& snapshot = kept.index->snapshot();
    return snapshot.epoch() == epoch && snapshot.revision() == revision && snapshot.utime() == utime;
  });
  if (found == kept_.end()) return nullptr;
  auto index = found->index;
  keep_locked(index, steady_now_s());
  return index;
}

/// Puts an index in front of those that are kept.
void IndexKeeper::keep_locked(const std::shared_ptr<const MapIndex>& index, double now_s) {
  if (kept_.empty()) woken_.notify_all();  // the thread forgets it when its time has come
  std::erase_if(kept_, [&](const Kept& kept) { return kept.index == index; });
  kept_.push_front({index, now_s});
  if (kept_.size() > kKeptIndexes) kept_.pop_back();
}

void IndexKeeper::forget_old(double now_s) {
  while (!kept_.empty() && kept_.back().asked_at_s + kept_s_ <= now_s) kept_.pop_back();
}

std::shared_ptr<const MapIndex> IndexKeeper::current() {
  std::unique_lock lock(mutex_);
  const auto newest = mapping_.snapshot();
  if (index_ && &index_->snapshot() == newest.get()) return index_;
  const double now_s = steady_now_s();
  const double age_s = now_s - taken_at_s_;
  const bool is_usable = index_ && index_->snapshot().epoch() == newest->epoch() && age_s < index_age_s_;
  // One that is being made is waited for where it will do, or else each caller would wait for two.
  const bool is_coming = begun_ > done_ && now_s - begun_at_s_ < index_age_s_ && coming_epoch_ == newest->epoch();
  if (!is_coming && (!is_usable || age_s > 0.5 * index_age_s_)) {
    wanted_ = begun_ + 1;
    woken_.notify_all();
  }
  if (is_usable) return index_;
  const std::uint64_t number = is_coming ? begun_ : begun_ + 1;
  built_.wait(lock, [&] { return done_ >= number || is_stopped_; });
  return index_;
}

void IndexKeeper::wake() {
  {
    const std::lock_guard lock(mutex_);
    has_news_ = true;
  }
  woken_.notify_all();
}

void IndexKeeper::add_watcher() {
  {
    const std::lock_guard lock(mutex_);
    ++watchers_;
  }
  woken_.notify_all();
}

void IndexKeeper::remove_watcher() {
  const std::lock_guard lock(mutex_);
  --watchers_;
}

bool IndexKeeper::has_to_build(double now_s) const {
  return wanted_ > begun_ || (watchers_ > 0 && has_news_ && now_s - taken_at_s_ >= watch_period_s_);
}

double IndexKeeper::due_in_s(double now_s) const {
  double due_s = kept_.empty() ? now_s + 3600.0 : kept_.back().asked_at_s + kept_s_;
  if (watchers_ > 0 && has_news_) due_s = std::min(due_s, taken_at_s_ + watch_period_s_);
  return std::max(0.0, due_s - now_s);
}

void IndexKeeper::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const double now_s = steady_now_s();
    forget_old(now_s);
    if (has_to_build(now_s)) {
      build(lock);
      continue;
    }
    const std::uint64_t wanted = wanted_;
    const int watchers = watchers_;
    const bool has_news = has_news_;
    const bool keeps_none = kept_.empty();
    // Wakes for what makes a difference: while nobody watches, the mapper's many snapshots do not.
    woken_.wait_for(lock, stop, std::chrono::duration<double>(due_in_s(now_s)), [&] {
      return wanted_ != wanted || watchers_ != watchers || (watchers_ > 0 && has_news_ != has_news) ||
             kept_.empty() != keeps_none;
    });
  }
}

void IndexKeeper::build(std::unique_lock<std::mutex>& lock) {
  const std::uint64_t number = ++begun_;
  has_news_ = false;
  const double taken_at_s = steady_now_s();
  const auto snapshot = mapping_.snapshot();
  begun_at_s_ = taken_at_s;
  coming_epoch_ = snapshot->epoch();
  const auto previous = index_;
  lock.unlock();
  std::shared_ptr<const MapIndex> index;
  try {
    const bool is_same = previous && &previous->snapshot() == snapshot.get();
    index = is_same ? previous : std::make_shared<const MapIndex>(snapshot, gravity_, previous.get());
  } catch (const std::exception& e) {
    spdlog::error("the map could not be made ready for queries: {}", e.what());
    index = previous;
  }
  if (index && index != previous) on_index_(index);
  lock.lock();
  index_ = std::move(index);
  taken_at_s_ = taken_at_s;
  done_ = number;
  built_.notify_all();
}

}  // namespace planemap::service

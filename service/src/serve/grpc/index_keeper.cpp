#include "serve/grpc/index_keeper.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "config/map_gravity.hpp"

namespace planemap::service {

IndexKeeper::IndexKeeper(const ServiceConfig& config, const MappingService& mapping, OnIndex on_index)
    : mapping_(mapping),
      gravity_(gravity_of(config.map)),
      index_age_s_(config.grpc.index_age_s),
      watch_period_s_(config.grpc.watch_period_s),
      on_index_(std::move(on_index)) {
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

std::shared_ptr<const MapIndex> IndexKeeper::current() {
  const auto newest = mapping_.snapshot();
  std::unique_lock lock(mutex_);
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
  constexpr double kLongS = 3600.0;
  return watchers_ > 0 && has_news_ ? std::max(0.0, taken_at_s_ + watch_period_s_ - now_s) : kLongS;
}

void IndexKeeper::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const double now_s = steady_now_s();
    if (has_to_build(now_s)) {
      build(lock);
      continue;
    }
    const std::uint64_t wanted = wanted_;
    const int watchers = watchers_;
    const bool has_news = has_news_;
    // Wakes for what makes a difference: while nobody watches, the mapper's many snapshots do not.
    woken_.wait_for(lock, stop, std::chrono::duration<double>(due_in_s(now_s)), [&] {
      return wanted_ != wanted || watchers_ != watchers || (watchers_ > 0 && has_news_ != has_news);
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

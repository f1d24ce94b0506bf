#include "serve/grpc/watch_hub.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "serve/grpc/watcher.hpp"

namespace planemap::service {
namespace {

constexpr double kLeastHeartbeatS = 0.1;
constexpr double kMostHeartbeatS = 3600.0;

/// A call that is not let in.
class Refused : public grpc::ServerWriteReactor<v1::WatchEvent> {
 public:
  explicit Refused(grpc::Status status) { Finish(std::move(status)); }
  void OnDone() override { delete this; }
};

}  // namespace

WatchHub::WatchHub(CallDesk& desk, double heartbeat_s)
    : desk_(desk), heartbeat_s_(heartbeat_s), thread_([this](const std::stop_token& stop) { run(stop); }) {}

WatchHub::~WatchHub() {
  stop();
}

grpc::Status WatchHub::check(const v1::WatchRequest& request) const {
  const double heartbeat_s = request.heartbeat_s();
  if (heartbeat_s == 0.0 || (heartbeat_s >= kLeastHeartbeatS && heartbeat_s <= kMostHeartbeatS))
    return grpc::Status::OK;
  return {grpc::StatusCode::INVALID_ARGUMENT,
          fmt::format("heartbeat_s: {} is out of range (allowed: {} to {}, or 0 for the server's {})", heartbeat_s,
                      kLeastHeartbeatS, kMostHeartbeatS, heartbeat_s_)};
}

grpc::ServerWriteReactor<v1::WatchEvent>* WatchHub::watch(grpc::CallbackServerContext* context,
                                                          const v1::WatchRequest& request) {
  grpc::Status status = desk_.admit(*context, Scope::kRead);
  if (status.ok()) status = check(request);
  if (status.ok()) status = desk_.enter_stream();
  if (!status.ok()) return new Refused(desk_.counted(std::move(status)));
  const double heartbeat_s = request.heartbeat_s() == 0.0 ? heartbeat_s_ : request.heartbeat_s();
  auto* watcher = new Watcher(*this, {request.epoch(), request.since_revision(), false}, heartbeat_s);
  add(*watcher);
  // Making an index may take a while, and gRPC's thread is not ours.
  desk_.pool.post([this] {
    if (auto index = keeper_->current()) on_index(std::move(index));
  });
  return watcher;
}

void WatchHub::add(Watcher& watcher) {
  bool is_late = false;
  {
    const std::lock_guard lock(mutex_);
    watchers_.insert(&watcher);
    is_late = is_stopped_;
  }
  keeper_->add_watcher();
  if (is_late) watcher.end({grpc::StatusCode::UNAVAILABLE, "planemapd is ending"});
}

void WatchHub::remove(Watcher& watcher) {
  {
    const std::lock_guard lock(mutex_);
    watchers_.erase(&watcher);
  }
  keeper_->remove_watcher();
  desk_.leave_stream();
}

void WatchHub::on_index(std::shared_ptr<const MapIndex> index) {
  {
    const std::lock_guard lock(mutex_);
    // A call may come with the index before the last one.
    const auto version = [](const MapIndex& i) { return std::pair(i.snapshot().epoch(), i.snapshot().revision()); };
    if (!index_ || version(*index_) <= version(*index)) index_ = std::move(index);
    has_news_ = true;
  }
  woken_.notify_all();
}

void WatchHub::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const double now_s = steady_now_s();
    double due_s = now_s + kMostHeartbeatS;
    const bool has_news = std::exchange(has_news_, false);
    for (Watcher* watcher : watchers_) {
      if (has_news) watcher->go_to(index_);
      due_s = std::min(due_s, watcher->beat(now_s));
    }
    woken_.wait_for(lock, stop, std::chrono::duration<double>(due_s - now_s), [this] { return has_news_; });
  }
}

void WatchHub::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  is_stopped_ = true;
  for (Watcher* watcher : watchers_) watcher->end({grpc::StatusCode::UNAVAILABLE, "planemapd is ending"});
}

}  // namespace planemap::service

#include "serve/grpc/watcher.hpp"

#include <utility>

#include "mapping/mapping_service.hpp"
#include "serve/grpc/watch_hub.hpp"

namespace planemap::service {

Watcher::Watcher(WatchHub& hub, const WatchPosition& position, double heartbeat_s)
    : hub_(hub), heartbeat_s_(heartbeat_s), position_(position), written_at_s_(steady_now_s()) {}

void Watcher::go_to(std::shared_ptr<const MapIndex> index) {
  {
    const std::lock_guard lock(mutex_);
    target_ = std::move(index);
  }
  step();
}

double Watcher::beat(double now_s) {
  double due_s = 0.0;
  {
    const std::lock_guard lock(mutex_);
    due_s = written_at_s_ + heartbeat_s_;
    if (due_s > now_s) return due_s;
    if (is_writing_) return now_s + heartbeat_s_;  // it does not read; one more event would tell it nothing
    wants_heartbeat_ = true;
  }
  step();
  return now_s + heartbeat_s_;
}

void Watcher::end(grpc::Status status) {
  {
    const std::lock_guard lock(mutex_);
    if (!end_) end_ = std::move(status);
  }
  step();
}

void Watcher::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    is_writing_ = false;
    if (!ok && !end_) end_ = grpc::Status::CANCELLED;
  }
  step();
}

void Watcher::OnCancel() {
  end(grpc::Status::CANCELLED);
}

void Watcher::OnDone() {
  hub_.remove(*this);  // waits for a hub that is just talking to it
  delete this;
}

/// Writes what comes next, or ends the call. From any thread.
void Watcher::step() {
  const v1::WatchEvent* event = nullptr;
  std::optional<grpc::Status> status;
  {
    const std::lock_guard lock(mutex_);
    if (is_writing_ || is_finished_) return;
    if (end_) {
      is_finished_ = true;
      status = end_;
    } else {
      event = next_event();
      if (event == nullptr) return;
      is_writing_ = true;
      written_at_s_ = steady_now_s();
    }
  }
  // Nobody else gets here before OnWriteDone().
  if (event != nullptr) {
    StartWrite(event);
  } else {
    Finish(hub_.desk_.counted(std::move(*status)));
  }
}

const v1::WatchEvent* Watcher::next_event() {
  if (events_ && next_ < events_->size()) return &(*events_)[next_++];
  events_ = nullptr;
  if (!target_) return nullptr;
  events_ = hub_.pages_.between(position_, target_);
  // The first event comes at once, whether there is news or not.
  if (!events_ && (wants_heartbeat_ || !position_.is_told)) events_ = heartbeat_event(target_->snapshot());
  wants_heartbeat_ = false;
  if (!events_) return nullptr;
  position_ = {target_->snapshot().epoch(), target_->snapshot().revision(), true};
  next_ = 1;
  return &events_->front();
}

}  // namespace planemap::service

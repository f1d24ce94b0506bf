#include "build/frame_prefetcher.hpp"

#include <utility>

namespace planemap::cli {

FramePrefetcher::FramePrefetcher(sources::FrameSource& source)
    : source_(source), thread_([this](const std::stop_token& stop) { read(stop); }) {}

FramePrefetcher::~FramePrefetcher() {
  thread_.request_stop();
  thread_.join();
}

void FramePrefetcher::read(const std::stop_token& stop) {
  std::optional<sources::Frame> frame;
  std::exception_ptr error;
  do {
    try {
      frame = source_.next();
    } catch (...) {
      frame.reset();
      error = std::current_exception();
    }
    std::unique_lock lock(mutex_);
    if (frame) {
      changed_.wait(lock, stop, [this] { return entries_.size() < kAhead; });
      entries_.push_back({std::move(*frame), source_.skipped()});
    } else {
      ended_ = true;
      skipped_at_end_ = source_.skipped();
      error_ = error;
    }
    changed_.notify_all();
  } while (frame && !stop.stop_requested());
}

std::optional<sources::Frame> FramePrefetcher::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !entries_.empty() || ended_; });
  if (entries_.empty()) {
    skipped_ = skipped_at_end_;
    if (error_) std::rethrow_exception(error_);
    return std::nullopt;
  }
  sources::Frame frame = std::move(entries_.front().frame);
  skipped_ = std::move(entries_.front().skipped);
  entries_.pop_front();
  changed_.notify_all();
  return frame;
}

}  // namespace planemap::cli

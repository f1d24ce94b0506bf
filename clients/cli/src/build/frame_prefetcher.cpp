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
      changed_.wait(lock, stop, [this] { return frames_.size() < kAhead; });
      frames_.push_back(std::move(*frame));
    } else {
      ended_ = true;
      error_ = error;
    }
    changed_.notify_all();
  } while (frame && !stop.stop_requested());
}

std::optional<sources::Frame> FramePrefetcher::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !frames_.empty() || ended_; });
  if (frames_.empty()) {
    if (error_) std::rethrow_exception(error_);
    return std::nullopt;
  }
  sources::Frame frame = std::move(frames_.front());
  frames_.pop_front();
  changed_.notify_all();
  return frame;
}

}  // namespace planemap::cli

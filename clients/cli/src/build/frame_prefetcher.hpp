#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <planemap/sources/frame_source.hpp>
#include <stop_token>
#include <string>
#include <thread>

namespace planemap::cli {

/// Reads frames on a thread of its own, a few ahead: images are decoded while the map grows. The frames are those of
/// the source, in its order.
class FramePrefetcher {
 public:
  using SkippedFrames = std::map<std::string, std::size_t>;

  /// @param source  not to be used by others while this lives
  explicit FramePrefetcher(sources::FrameSource& source);
  ~FramePrefetcher();
  FramePrefetcher(const FramePrefetcher&) = delete;
  FramePrefetcher& operator=(const FramePrefetcher&) = delete;

  /// The next frame; empty at the end. Throws what the source threw.
  std::optional<sources::Frame> next();
  /// Frames that were passed over before what next() gave last, by reason: those read ahead do not count yet.
  const SkippedFrames& skipped() const { return skipped_; }

 private:
  static constexpr std::size_t kAhead = 4;

  struct Entry {
    sources::Frame frame;
    SkippedFrames skipped;
  };

  void read(const std::stop_token& stop);

  sources::FrameSource& source_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Entry> entries_;
  bool ended_ = false;
  SkippedFrames skipped_;  ///< of the entries that were taken
  SkippedFrames skipped_at_end_;
  std::exception_ptr error_;
  std::jthread thread_;
};

}  // namespace planemap::cli

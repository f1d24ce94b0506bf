#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

#include "feed.hpp"

namespace planemap::kinect_bridge {

/// A line on stderr that is written over a few times a second; nothing where stderr is no terminal.
class Progress {
 public:
  /// @param frames  expected; empty: not known
  Progress(bool wanted, std::optional<std::size_t> frames);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const FeedReport& report);

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_here_;
  std::optional<std::size_t> frames_;
  bool on_screen_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = begin_;
};

}  // namespace planemap::kinect_bridge

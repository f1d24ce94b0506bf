#pragma once

#include <chrono>
#include <csignal>

namespace planemap::kinect_bridge {

/// SIGINT and SIGTERM as a request to stop. Blocks them for this thread and those that it starts: make one before
/// others.
class StopSignals {
 public:
  StopSignals();

  /// Waits until a time; true as soon as there was a request, now or before.
  bool wait_until(std::chrono::steady_clock::time_point time);

 private:
  sigset_t signals_;
  bool requested_ = false;
};

}  // namespace planemap::kinect_bridge

#include "stop_signals.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace planemap::kinect_bridge {

StopSignals::StopSignals() : signals_() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
}

bool StopSignals::wait_until(std::chrono::steady_clock::time_point time) {
  using std::chrono::nanoseconds;
  while (!requested_) {
    const nanoseconds left = std::max<nanoseconds>(time - std::chrono::steady_clock::now(), nanoseconds::zero());
    timespec timeout{};
    timeout.tv_sec = static_cast<std::time_t>(left.count() / 1'000'000'000);
    timeout.tv_nsec = static_cast<long>(left.count() % 1'000'000'000);
    if (sigtimedwait(&signals_, nullptr, &timeout) > 0) {
      requested_ = true;
    } else if (errno == EAGAIN) {
      return false;
    }  // else another signal came in between
  }
  return true;
}

}  // namespace planemap::kinect_bridge

#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace planemap::service {

/// What is told to systemd (Type=notify), where it started the daemon: NOTIFY_SOCKET of the environment says so, and
/// elsewhere nothing is done.
class ServiceManager {
 public:
  /// Looks at WATCHDOG_USEC of the environment.
  ServiceManager();

  void ready(const std::string& status);
  void stopping();
  /// One line for systemctl status.
  void status(const std::string& text);
  /// Still alive.
  void beat();
  /// How often beat() is wanted: half of the time after which the daemon would be ended; empty: never.
  std::optional<std::chrono::microseconds> beat_period() const { return beat_period_; }

 private:
  std::optional<std::chrono::microseconds> beat_period_;
};

}  // namespace planemap::service

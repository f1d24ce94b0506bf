#include "service_manager.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace planemap::service {
namespace {

void notify(const std::string& state) {
  const int result = sd_notify(/*unset_environment=*/0, state.c_str());
  if (result < 0) spdlog::warn("the service manager cannot be told '{}': {}", state, std::strerror(-result));
}

/// On one line, as the protocol needs it.
std::string line_of(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

ServiceManager::ServiceManager() {
  std::uint64_t watchdog_us = 0;
  const int result = sd_watchdog_enabled(/*unset_environment=*/0, &watchdog_us);
  if (result < 0) spdlog::warn("WATCHDOG_USEC of the environment cannot be used: {}", std::strerror(-result));
  if (result > 0) beat_period_ = std::chrono::microseconds(watchdog_us / 2);
}

void ServiceManager::ready(const std::string& status) {
  notify("READY=1\nSTATUS=" + line_of(status));
}

void ServiceManager::stopping() {
  notify("STOPPING=1\nSTATUS=ending");
}

void ServiceManager::status(const std::string& text) {
  notify("STATUS=" + line_of(text));
}

void ServiceManager::beat() {
  notify("WATCHDOG=1");
}

}  // namespace planemap::service

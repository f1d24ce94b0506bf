#pragma once

#include <cstdint>
#include <memory>
#include <planemap/expected.hpp>
#include <span>
#include <string>

namespace planemap::kinect_bridge {

/// Where messages go.
class Sink {
 public:
  virtual ~Sink() = default;
  /// @param utime  microseconds, of the message
  virtual Expected<void> put(const std::string& channel, std::int64_t utime, std::span<const std::uint8_t> bytes) = 0;
};

/// Publishes over LCM. Fails, saying what to do, if LCM can't be used with the URL.
Expected<std::unique_ptr<Sink>> open_lcm_sink(const std::string& url);

/// Writes an LCM event log; the events' times are the messages' own.
Expected<std::unique_ptr<Sink>> open_log_sink(const std::string& path);

}  // namespace planemap::kinect_bridge

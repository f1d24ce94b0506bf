#pragma once

#include <chrono>
#include <cstdint>

namespace planemap::service {

/// The host's clock: microseconds since 1970.
inline std::int64_t utime_now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace planemap::service

#pragma once

#include <chrono>
#include <planemap/expected.hpp>
#include <string>

namespace planemap::service {

/// Whoever keeps the map beyond the life of the process.
class MapKeeper {
 public:
  virtual ~MapKeeper() = default;
  /// Commits the map as it is now. From any thread; the mapper does not wait.
  virtual Expected<void> save(std::chrono::steady_clock::duration timeout) = 0;
  /// Why the map is not being kept, in words; empty: it is. From any thread.
  virtual std::string problem() const = 0;
};

}  // namespace planemap::service

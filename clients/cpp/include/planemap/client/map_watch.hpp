#pragma once

#include <chrono>
#include <cstdint>
#include <planemap/client/map_types.hpp>
#include <vector>

namespace planemap::client {

struct RemovedPlane {
  std::int64_t id = 0;
  std::int64_t merged_into = 0;  ///< 0: it is gone, or that is not known
};

/// What has changed in a mirrored map.
struct MapChange {
  std::int64_t epoch = 0;
  std::int64_t since_revision = 0;  ///< -1: there was no map of this epoch before
  std::int64_t revision = 0;
  bool new_map = false;    ///< the first one, or one of another epoch: its ids mean other planes than those before
  bool caught_up = false;  ///< told by a whole snapshot: at the start, or since news were lost
  std::vector<std::int64_t> added;    ///< ascending, as the next one
  std::vector<std::int64_t> changed;  ///< of these, the mirror holds the planes as they are now
  std::vector<RemovedPlane> removed;

  bool empty() const { return !new_map && added.empty() && changed.empty() && removed.empty(); }
};

/// A map that is kept up to date. Whatever is lost or comes late, out of order or twice, the mirror is at each moment
/// the map at one revision, and ends as the service's map.
class MapWatch {
 public:
  MapWatch() = default;
  virtual ~MapWatch() = default;
  MapWatch(const MapWatch&) = delete;
  MapWatch& operator=(const MapWatch&) = delete;

  /// Waits for the next change and applies it. The first one is the whole map.
  /// @return what has changed; empty() where nothing did within the timeout though the service lives. Fails
  ///         (kUnreachable) where nothing was heard of it; the mirror stays, and the watch may be asked on.
  virtual Expected<MapChange> next(std::chrono::milliseconds timeout) = 0;
  /// The map as it was last heard of, without cells.
  virtual const Map& map() const = 0;
};

}  // namespace planemap::client

#pragma once

#include <planemap/v1/map.pb.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "serve/grpc/map_index.hpp"

namespace planemap::service {

/// Events that a watcher gets together; immutable, shared by those who stand at the same revision.
using WatchEvents = std::shared_ptr<const std::vector<v1::WatchEvent>>;

/// Where a watcher stands.
struct WatchPosition {
  std::uint64_t epoch = 0;  ///< 0: it has no map
  std::uint64_t revision = 0;
  bool is_told = false;  ///< it had an event, so the position is one that we gave it
};

/// What brings a watcher to an index: a delta in pages of at most 1 MiB, or that a snapshot is needed; empty where
/// nothing has changed. Thread-safe; the events of the newest index are kept for other watchers.
class DeltaPages {
 public:
  WatchEvents between(const WatchPosition& position, const std::shared_ptr<const MapIndex>& index);

 private:
  std::mutex mutex_;
  std::shared_ptr<const MapIndex> index_;
  std::map<std::uint64_t, WatchEvents> by_revision_;  ///< deltas of index_, by the revision that they begin at
};

/// An event that says that nothing has changed.
WatchEvents heartbeat_event(const MapSnapshot& snapshot);

}  // namespace planemap::service

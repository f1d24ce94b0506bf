#pragma once

#include <Eigen/Core>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <planemap/query/snapshot_queries.hpp>
#include <planemap/snapshot.hpp>

#include "config/service_config.hpp"

namespace planemap::service {

/// What is told of snapshots beside their records: boundaries, classes, and the index that queries go by. Made once for
/// a snapshot, from the one before: only what has changed is made anew. Deltas and answers share it. Safe from any
/// thread; who asks for what is being made waits for it.
class PlaneBook {
 public:
  explicit PlaneBook(const MapConfig& config);

  /// @param snapshot  not nullptr
  std::shared_ptr<const SnapshotQueries> open(const std::shared_ptr<const MapSnapshot>& snapshot);

 private:
  std::optional<Eigen::Vector3d> gravity_;
  std::mutex mutex_;
  std::deque<std::shared_ptr<const SnapshotQueries>> recent_;  ///< the last that were asked for, the latest in front
};

}  // namespace planemap::service

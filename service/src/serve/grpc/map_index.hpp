#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <planemap/query/snapshot_queries.hpp>
#include <vector>

namespace planemap::service {

/// A snapshot ready to be asked, shared by all calls that it answers. Immutable.
class MapIndex {
 public:
  /// @param gravity   as SnapshotQueries takes it
  /// @param previous  the index before, or nullptr: what has not changed is taken from it. Not kept.
  MapIndex(const std::shared_ptr<const MapSnapshot>& snapshot, const std::optional<Eigen::Vector3d>& gravity,
           const MapIndex* previous);

  const SnapshotQueries& queries() const { return queries_; }
  const MapSnapshot& snapshot() const { return queries_.snapshot(); }
  /// For each plane, by place in queries().planes(): the revision since which its record and class are as they are now,
  /// or a later one. A class may change with another plane, the record staying as it is.
  const std::vector<std::uint64_t>& changed_revisions() const { return changed_revisions_; }

 private:
  SnapshotQueries queries_;
  std::vector<std::uint64_t> changed_revisions_;
};

}  // namespace planemap::service

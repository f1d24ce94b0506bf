#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <planemap/described_plane.hpp>
#include <planemap/expected.hpp>
#include <planemap/query/floorplan.hpp>
#include <planemap/query/nearest.hpp>
#include <planemap/query/plane_filter.hpp>
#include <planemap/query/plane_lookup.hpp>
#include <planemap/query/ray_cast.hpp>
#include <planemap/query/region.hpp>
#include <planemap/snapshot.hpp>
#include <span>
#include <vector>

namespace planemap {

struct QueryIndex;

/// Answers queries on one snapshot. Immutable once it is made: any number of threads may ask it. Making it costs what
/// has changed since an earlier one (docs/queries.md), so make it when somebody asks.
///
/// Arguments come from outside: those that make no sense give an Error that names the argument and its limit. Numbers
/// must be finite unless it says otherwise, and coordinates within kMaxQueryCoordinateM. Planes without a boundary (all
/// their cells have too few points to be dense) have no surface: only plane() knows them.
class SnapshotQueries {
 public:
  /// @param snapshot  not nullptr
  /// @param gravity   points down in the world frame, any length but 0; empty: not known, every class is kOther, and
  ///                  there is no floorplan. Throws std::invalid_argument if it is zero or not finite.
  /// @param previous  of an earlier snapshot of the same map, or nullptr: outlines of planes that have not changed are
  ///                  taken from it. Not kept.
  explicit SnapshotQueries(std::shared_ptr<const MapSnapshot> snapshot,
                           const std::optional<Eigen::Vector3d>& gravity = std::nullopt,
                           const SnapshotQueries* previous = nullptr);
  /// The same with outlines and classes that are known already.
  /// @param planes  all of the snapshot's, by id, each with its outline; else throws std::invalid_argument
  SnapshotQueries(std::shared_ptr<const MapSnapshot> snapshot, std::vector<DescribedPlane> planes,
                  const std::optional<Eigen::Vector3d>& gravity = std::nullopt,
                  const SnapshotQueries* previous = nullptr);
  ~SnapshotQueries();
  SnapshotQueries(const SnapshotQueries&) = delete;
  SnapshotQueries& operator=(const SnapshotQueries&) = delete;

  const MapSnapshot& snapshot() const;
  /// All planes, by id.
  std::span<const DescribedPlane> planes() const;

  /// The planes whose surfaces are nearest to a point, nearest first; equally near ones by id.
  Expected<std::vector<NearPlane>> nearest(const NearestQuery& query) const;
  /// For each ray the first plane and the first dense cell that it meets, in the same order. One bad ray fails all.
  Expected<std::vector<RayHits>> cast(std::span<const Ray> rays, const CastOptions& options = {}) const;
  /// What is in a part of space.
  Expected<RegionContents> region(const RegionQuery& query) const;
  /// Everything about one plane, also where it was merged into another. Fails for id 0 only; see PlaneFate.
  Expected<PlaneLookup> plane(PlaneId id) const;
  /// The planes that pass a filter, those without a boundary too.
  Expected<FilterMatch> matching(const PlaneFilter& filter) const;
  /// Walls and free floor seen from above. Fails also where gravity is not known, or no floor was seen.
  Expected<Floorplan> floorplan(const FloorplanQuery& query = {}) const;

 private:
  std::unique_ptr<const QueryIndex> index_;
};

}  // namespace planemap

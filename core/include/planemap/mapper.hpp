#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <planemap/config.hpp>
#include <planemap/expected.hpp>
#include <planemap/pose_covariance.hpp>
#include <planemap/scan.hpp>
#include <planemap/second_thread.hpp>
#include <planemap/snapshot.hpp>

namespace planemap {

/// The steps of the method (paper, Fig. 3 and Fig. 6; wear is ours), in order.
enum class Stage { kAssign, kNormals, kLocalPlanes, kGlobalPlanes, kWear, kSnapshot };
constexpr std::size_t kStageCount = 6;
constexpr const char* name_of(Stage stage) {
  constexpr const char* kNames[] = {"assign", "normals", "localPlanes", "globalPlanes", "wear", "snapshot"};
  return kNames[static_cast<std::size_t>(stage)];
}

/// Told when each stage begins and ends: core knows no clock, its caller may.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void stage_begins(Stage stage) = 0;
  virtual void stage_ends(Stage stage) = 0;
};

/// What became of one scan.
struct ScanReport {
  PointCounts points;
  std::size_t touched_cells = 0;  ///< cells that got points
  std::size_t local_planes = 0;   ///< of this scan
  std::size_t new_planes = 0;
  std::size_t merged_planes = 0;
  std::size_t worn_cells = 0;   ///< cells that lost their points, since scans see through them
  bool planes_changed = false;  ///< the revision grew
};

/// What became of another map that was added.
struct AdditionReport {
  std::size_t added_cells = 0;    ///< of the other map
  std::size_t new_planes = 0;     ///< that began, the merged ones included
  std::size_t merged_planes = 0;  ///< that became part of others
};

/// The whole method: scans with poses in, snapshots out. Not thread-safe: one thread owns it. Deterministic: the same
/// configuration and the same calls give the same map.
class Mapper {
 public:
  /// @param epoch   names this life of the map; below 2^53
  /// @param second  does some of the work, and the map is the same; not owned, outlives the mapper. nullptr: the
  ///                caller's thread does it all
  Mapper(const MapperConfig& config, std::uint64_t epoch, SecondThread* second = nullptr);
  /// Goes on with a map that a mapper made, from any of its snapshots: planes keep ids, records and evidence to the
  /// bit, the next plane gets state().next_plane_id. Not kept are for how long cells have been seen through, and the
  /// order in which the cells of large planes joined them. The error says what is wrong with the map: it is checked as
  /// one from outside (blocks twice, numbers that are not finite, labels without a plane, planes that count other cells
  /// than carry their label), and its cells must be of the configured size.
  static Expected<Mapper> restore(const MapperConfig& config, const MapSnapshot& map, SecondThread* second = nullptr);
  ~Mapper();
  Mapper(Mapper&&) noexcept;
  Mapper& operator=(Mapper&&) noexcept;

  /// Maps one registered scan (paper, Fig. 3).
  /// @param T_world_sensor   takes sensor coordinates to world coordinates
  /// @param observer         may be nullptr
  /// @param pose_covariance  of T_world_sensor, positive semi-definite; empty: config.pose_error
  ScanReport integrate(const Scan& scan, const Eigen::Isometry3d& T_world_sensor, StageObserver* observer = nullptr,
                       const std::optional<PoseCovariance>& pose_covariance = std::nullopt);

  /// Adds all that another map has seen: the sums of cells add up, and planes go through the same steps as those of
  /// scans. Without a transform the sums are those of a map that saw the scans of both, to rounding, in whatever order
  /// maps are added, as far as the same scans assign their points to the same cells. The other map's planes keep
  /// neither ids nor extents: they are found anew in the cells. How far the errors of its poses are shared by its
  /// scans is not kept in cells: where poses err, its evidence counts as seen with the error of its last pose.
  /// @param T_ours_theirs  from the other map's frame to ours; empty: they are the same
  /// @param progress       called now and then with the share that is done, 0 to 1; may be empty
  /// @return fails if the other map is not whole (restore()), or its cells are of another size; nothing was added then
  Expected<AdditionReport> add(const MapSnapshot& other,
                               const std::optional<Eigen::Isometry3d>& T_ours_theirs = std::nullopt,
                               const std::function<void(double)>& progress = {});

  /// The map as it is now; costs what changed since the last call.
  std::shared_ptr<const MapSnapshot> snapshot(StageObserver* observer = nullptr);

 private:
  class Impl;
  explicit Mapper(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap

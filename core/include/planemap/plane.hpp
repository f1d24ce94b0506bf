#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <planemap/expected.hpp>
#include <string_view>
#include <vector>

namespace planemap {

/// Names a plane for ever: ids grow and are never used again. 0 is no plane.
using PlaneId = std::uint64_t;
constexpr PlaneId kNoPlane = 0;

/// The plane {x : normal . x + d = 0}, world frame, |normal| = 1, normal towards the side from which it was seen.
class Plane {
 public:
  /// Scales normal and d together; fails if the normal is zero or a number is not finite.
  static Expected<Plane> from_coefficients(const Eigen::Vector3d& normal, double d);
  /// The same numbers, to the bit, as a plane had that was written down; fails unless |unit_normal| = 1 to 1e-9 and all
  /// are finite.
  static Expected<Plane> from_unit_normal(const Eigen::Vector3d& unit_normal, double d);
  /// The plane through a point. @pre |unit_normal| = 1
  static Plane through(const Eigen::Vector3d& point_m, const Eigen::Vector3d& unit_normal);

  const Eigen::Vector3d& normal() const { return normal_; }
  double d() const { return d_; }  ///< metres
  double signed_distance_m(const Eigen::Vector3d& p_world_m) const { return normal_.dot(p_world_m) + d_; }

 private:
  Plane(const Eigen::Vector3d& normal, double d) : normal_(normal), d_(d) {}
  Eigen::Vector3d normal_;
  double d_;
};

/// What a surface is, by gravity; kOther where the map knows no gravity.
enum class PlaneClass : std::uint8_t { kOther, kFloor, kCeiling, kWall, kTable, kSlope };

constexpr std::string_view name_of(PlaneClass c) {
  switch (c) {
    case PlaneClass::kFloor:
      return "floor";
    case PlaneClass::kCeiling:
      return "ceiling";
    case PlaneClass::kWall:
      return "wall";
    case PlaneClass::kTable:
      return "table";
    case PlaneClass::kSlope:
      return "slope";
    case PlaneClass::kOther:
      break;
  }
  return "other";
}

struct PlaneState;

/// A plane of the map as readers see it; never changed once it was published.
struct PlaneRecord {
  PlaneId id = kNoPlane;
  Plane plane = Plane::through(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of (nx, ny, nz, d); rank 3; d in metres
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();  ///< of its points, world frame
  std::uint32_t cell_count = 0;
  std::uint64_t point_count = 0;
  std::int64_t first_seen_utime = 0;  ///< microseconds
  std::int64_t last_seen_utime = 0;   ///< microseconds
  double quality = 0.0;               ///< 0 to 1: share of its points in cells that agree with it and shape it
  std::uint64_t revision = 0;         ///< of the map, when this record was made
  std::vector<PlaneId> merged;        ///< ids of the planes that were merged into it, ascending
  /// What the mapper needs to go on with the plane; nullptr in records that no mapper made.
  std::shared_ptr<const PlaneState> state;
};

/// A plane that is no more.
struct RemovedPlane {
  PlaneId id = kNoPlane;
  PlaneId merged_into = kNoPlane;  ///< the plane that holds it now; kNoPlane: it is gone
  std::uint64_t revision = 0;      ///< of the map, when it was removed
};

}  // namespace planemap

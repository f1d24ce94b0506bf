#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/outline.hpp>
#include <planemap/query/region.hpp>
#include <vector>

#include "query/clip.hpp"

namespace planemap {

/// The points with normal . x <= offset_m.
struct HalfSpace {
  Eigen::Vector3d normal;  ///< unit
  double offset_m = 0.0;
};

/// The points at most a radius away from a point, or from a line.
struct Round {
  Eigen::Vector3d centre_m;
  Eigen::Matrix3d across;  ///< takes away what of a vector is along the line; the identity for a point
  double radius_m = 0.0;

  double distance_m(const Eigen::Vector3d& p_m) const { return (across * (p_m - centre_m)).norm(); }
};

/// A region as the points that are in all of its half-spaces and in its round, if it has one: convex.
struct RegionShape {
  Eigen::AlignedBox3d bounds;  ///< holds the region; sides may be infinite
  std::vector<HalfSpace> half_spaces;
  std::optional<Round> round;

  /// Points on the border, up to kOnBorderM, are in it.
  bool contains(const Eigen::Vector3d& p_m) const;
  /// Its half-spaces where they cut a plane.
  std::vector<HalfPlane> half_planes_on(const PlaneBasis& basis) const;
};

/// The shape of a region, or what is wrong with it.
Expected<RegionShape> shape_of(const Region& region);

/// Where a round cuts a plane: |offset + map x| <= radius.
class RoundOnPlane {
 public:
  RoundOnPlane(const Round& round, const PlaneBasis& basis);

  /// Whether any point within the rings is in the round.
  bool touches(const std::vector<Ring>& rings) const;
  /// The cut as half-planes: a polygon of 64 corners and equal area, or a strip where a cylinder lies along the plane.
  /// Empty: the round does not reach the plane.
  std::optional<std::vector<HalfPlane>> half_planes() const;

 private:
  Eigen::Matrix<double, 3, 2> map_;
  Eigen::Vector3d offset_m_;
  double radius_m_;
  Eigen::Matrix2d axes_;               ///< columns: main axes of the ellipse
  Eigen::Vector2d squared_stretches_;  ///< along them
  Eigen::Vector2d centre_m_;           ///< of the ellipse or strip
};

}  // namespace planemap

#pragma once

#include <Eigen/Core>
#include <planemap/plane.hpp>
#include <span>
#include <vector>

namespace planemap {

/// Right-handed basis on a plane: axis_u x axis_v = normal. A point is origin_m + u * axis_u + v * axis_v.
struct PlaneBasis {
  Eigen::Vector3d origin_m;  ///< on the plane, world frame
  Eigen::Vector3d axis_u;
  Eigen::Vector3d axis_v;

  Eigen::Vector3d to_world(const Eigen::Vector2d& uv_m) const {
    return origin_m + uv_m.x() * axis_u + uv_m.y() * axis_v;
  }
  Eigen::Vector2d to_plane(const Eigen::Vector3d& p_world_m) const {
    return {(p_world_m - origin_m).dot(axis_u), (p_world_m - origin_m).dot(axis_v)};
  }
};

/// A ring without its first point again at the end, metres in the plane's basis.
using Ring = std::vector<Eigen::Vector2d>;

struct Polygon {
  Ring outer;               ///< counter-clockwise seen from the normal's side
  std::vector<Ring> holes;  ///< clockwise
};

/// Positive for counter-clockwise rings.
double signed_area_m2(const Ring& ring);
/// Area of polygons, holes taken off.
double area_m2(std::span<const Polygon> polygons);

/// The seen part of a plane.
struct Outline {
  PlaneBasis basis;
  std::vector<Polygon> polygons;  ///< largest first
  double area_m2 = 0.0;           ///< of the polygons before they were simplified
};

/// The basis of a plane at a point: depends on the normal alone for its directions, so equal planes have equal bases.
PlaneBasis basis_of(const Plane& plane, const Eigen::Vector3d& centroid_m);

/// Outline of the cells of one plane: the union of squares of a cell's size about the cells' centres, gaps of less than
/// a cell closed, corners simplified to a quarter of a cell.
/// @param cell_centres_m  virtual centres of the plane's cells, world frame
Outline outline_of(const Plane& plane, const Eigen::Vector3d& centroid_m,
                   std::span<const Eigen::Vector3d> cell_centres_m, double cell_size_m);

}  // namespace planemap

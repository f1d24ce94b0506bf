#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <planemap/outline.hpp>
#include <vector>

namespace planemap {

/// Triangles of the seen part of a plane, holes left out.
struct PlaneMesh {
  std::vector<Eigen::Vector3d> vertices_m;              ///< world frame
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from the normal's side
};

/// Cuts polygons into triangles, by way of trapezoids (Boost.Polygon). Corners are rounded to a tenth of a millimetre
/// in the plane.
PlaneMesh mesh_of(const Outline& outline);

}  // namespace planemap

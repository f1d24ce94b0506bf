#pragma once

#include <Eigen/Geometry>
#include <planemap/assignment.hpp>
#include <planemap/plane.hpp>
#include <planemap/uncertain_grid.hpp>

#include "simd/point_kernels.hpp"

namespace planemap {

/// The scan's view of one frame: what a divider's planes are made for.
struct ScanFrame {
  CellIndex base;  ///< the cell that the sensor is in
  Eigen::Isometry3d T_world_sensor;
  double cell_size_m;
  double pose_variance_m2;  ///< of a point's distance to its plane
};

/// A plane for the kernels. A point is on it up to 4.5 sigma, and nearer than what a sensor bends surfaces by in any
/// case; none is on a plane that turns its back to the sensor.
/// @param plane  nullptr: not known; points that are not on the other plane of a divider are on this one
simd::ScanPlane scan_plane(const Plane* plane, const ScanFrame& frame);

}  // namespace planemap

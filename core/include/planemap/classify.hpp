#pragma once

#include <Eigen/Core>
#include <optional>
#include <planemap/plane.hpp>
#include <span>
#include <vector>

namespace planemap {

/// What the classes of planes go by.
struct Surface {
  Plane plane;
  Eigen::Vector3d centroid_m;  ///< world frame
  double area_m2 = 0.0;
};

/// The class of each surface, in the same order. Up-facing (normal within 15 degrees of up): floor if not more than 0.3
/// m above the lowest large up-facing surface (0.5 m2 and more), else table; down-facing: ceiling; within 15 degrees of
/// upright: wall; all between: slope.
/// @param gravity  points down in the world frame, any length but 0; empty: not known, every class is kOther
std::vector<PlaneClass> classify(std::span<const Surface> surfaces, const std::optional<Eigen::Vector3d>& gravity);

}  // namespace planemap

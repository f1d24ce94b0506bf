#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace planemap {

/// Axes of a floor plan: looking down, x to the right, y up the page.
struct PlanAxes {
  Eigen::Vector3d axis_x = Eigen::Vector3d::UnitX();
  Eigen::Vector3d axis_y = Eigen::Vector3d::UnitY();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< axis_x x axis_y

  Eigen::Vector2d to_plan(const Eigen::Vector3d& p_world_m) const {
    return {p_world_m.dot(axis_x), p_world_m.dot(axis_y)};
  }
};

/// A wall as it turns a plan.
struct SizedWall {
  Eigen::Vector3d normal;  ///< unit, world frame
  double area_m2 = 0.0;
};

/// World x to the right (where that is upright, y), then turned so that most of the walls' area runs along the axes.
PlanAxes plan_axes(const Eigen::Vector3d& up, std::span<const SizedWall> walls);

/// A piece of a wall along its trace in the plan.
struct Interval {
  double from_m;
  double to_m;
};

/// Overlapping ones joined, and those with so little between them as what hangs on a wall, or a frame of the scan that
/// missed it; ascending.
std::vector<Interval> joined(std::vector<Interval> intervals);

}  // namespace planemap

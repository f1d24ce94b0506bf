#pragma once

#include <Eigen/Core>
#include <planemap/outline.hpp>
#include <planemap/query/plane_filter.hpp>
#include <vector>

namespace planemap {

/// What is solid, and where can one go? Heights are above the floor.
struct FloorplanQuery {
  /// A wall is drawn where there is any of it between these heights: over most furniture, under lintels.
  double cut_low_m = 0.9;
  double cut_high_m = 1.5;
  double wall_thickness_m = 0.1;  ///< of the matter behind a wall's surface, > 0
  /// Floor is free where no dense cell lies between these heights: over what wheels take, under what a head passes.
  double clear_low_m = 0.1;
  double clear_high_m = 1.8;
  PlaneFilter filter;  ///< of walls and floors; obstacles count whatever it says
};

/// Axes of the plan: a point is axis_x x + axis_y y + up height. Turned so that most walls run along them.
struct PlanAxes {
  Eigen::Vector3d axis_x = Eigen::Vector3d::UnitX();
  Eigen::Vector3d axis_y = Eigen::Vector3d::UnitY();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< axis_x x axis_y

  Eigen::Vector2d to_plan(const Eigen::Vector3d& p_world_m) const {
    return {p_world_m.dot(axis_x), p_world_m.dot(axis_y)};
  }
};

/// Polygons in metres along the plan's axes, largest first: outer rings counter-clockwise seen from above.
struct Floorplan {
  PlanAxes axes;
  double floor_height_m = 0.0;      ///< of the lowest floor, along up
  std::vector<Polygon> walls;       ///< what stands, from its seen surface wall_thickness_m inwards
  std::vector<Polygon> floor;       ///< floor that was seen
  std::vector<Polygon> free_floor;  ///< the part of it that neither walls nor anything else stand on
  double free_area_m2 = 0.0;
};

}  // namespace planemap

#pragma once

#include <Eigen/Core>
#include <planemap/outline.hpp>
#include <planemap/plan.hpp>
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

#pragma once

#include <Eigen/Core>
#include <planemap/plan.hpp>
#include <vector>

#include "export/export_map.hpp"

namespace planemap {

using Point2 = Eigen::Vector2d;

/// A surface that is seen from above: level, or leaning.
struct PlanArea {
  PlaneId id = kNoPlane;
  bool floor = false;    ///< else something above it
  bool leaning = false;  ///< a slope
  double height_m = 0.0;
  double area_m2 = 0.0;
  std::vector<std::vector<Point2>> rings;  ///< outer ones and holes; fill by the even-odd rule; metres
};

struct PlanSegment {
  Point2 from;  ///< metres
  Point2 to;
};

/// An upright surface, seen edge-on.
struct PlanWall {
  PlaneId id = kNoPlane;
  Point2 normal;                      ///< unit, towards the side from which it was seen
  std::vector<PlanSegment> standing;  ///< where it is met between kCutLowM and kCutHighM above the floor
  std::vector<PlanSegment> extent;    ///< where there is any of it, at whatever height
};

// A plan shows what is cut at about the height of a table's edge to the shoulder: over most furniture, under lintels.
constexpr double kCutLowM = 0.9;
constexpr double kCutHighM = 1.5;

/// Planes as they are drawn in a floor plan. Ceilings are left out: they would hide everything.
struct FloorPlan {
  PlanAxes frame;
  std::vector<PlanArea> areas;  ///< lowest first
  std::vector<PlanWall> walls;
  Point2 min_m = Point2::Zero();
  Point2 max_m = Point2::Zero();  ///< equal to min_m: nothing to draw
};

/// @param map  where its gravity is not known, down is -z
FloorPlan floor_plan_of(const ExportMap& map);

}  // namespace planemap

#include "export/floor_plan.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <planemap/classify.hpp>

namespace planemap {
namespace {

constexpr double kCutStepM = 0.1;

std::vector<PlaneClass> classes_of(const ExportMap& map, const Eigen::Vector3d& down) {
  std::vector<Surface> surfaces;
  surfaces.reserve(map.planes.size());
  for (const ExportPlane& plane : map.planes) {
    surfaces.push_back({plane.record.plane, plane.record.centroid_m, plane.outline.area_m2});
  }
  return classify(surfaces, down);
}

PlanAxes axes_of(const ExportMap& map, const std::vector<PlaneClass>& classes, const Eigen::Vector3d& up) {
  std::vector<SizedWall> walls;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (classes[i] != PlaneClass::kWall) continue;
    walls.push_back({map.planes[i].record.plane.normal(), map.planes[i].outline.area_m2});
  }
  return plan_axes(up, walls);
}

/// Height of the lowest floor; empty: none was seen.
std::optional<double> floor_height_m(const ExportMap& map, const std::vector<PlaneClass>& classes,
                                     const Eigen::Vector3d& up) {
  std::optional<double> lowest_m;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (classes[i] != PlaneClass::kFloor) continue;
    const double height_m = map.planes[i].record.centroid_m.dot(up);
    lowest_m = std::min(lowest_m.value_or(height_m), height_m);
  }
  return lowest_m;
}

PlanArea area_of(const ExportPlane& plane, PlaneClass plane_class, const PlanAxes& frame) {
  PlanArea area;
  area.id = plane.record.id;
  area.floor = plane_class == PlaneClass::kFloor;
  area.leaning = plane_class == PlaneClass::kSlope;
  area.height_m = plane.record.centroid_m.dot(frame.up);
  area.area_m2 = plane.outline.area_m2;
  const auto add = [&](const Ring& ring) {
    std::vector<Point2>& points = area.rings.emplace_back();
    points.reserve(ring.size());
    for (const Eigen::Vector2d& uv_m : ring) points.push_back(frame.to_plan(plane.outline.basis.to_world(uv_m)));
  };
  for (const Polygon& polygon : plane.outline.polygons) {
    add(polygon.outer);
    for (const Ring& hole : polygon.holes) add(hole);
  }
  return area;
}

/// A wall's boundary in (along, height), metres: along is measured on its trace in the plan.
using Elevation = std::vector<std::vector<Point2>>;

Elevation elevation_of(const ExportPlane& plane, const PlanAxes& frame, const Eigen::Vector3d& along) {
  Elevation rings;
  const auto add = [&](const Ring& ring) {
    std::vector<Point2>& points = rings.emplace_back();
    for (const Eigen::Vector2d& uv_m : ring) {
      const Eigen::Vector3d p_m = plane.outline.basis.to_world(uv_m);
      points.emplace_back(p_m.dot(along), p_m.dot(frame.up));
    }
  };
  for (const Polygon& polygon : plane.outline.polygons) {
    add(polygon.outer);
    for (const Ring& hole : polygon.holes) add(hole);
  }
  return rings;
}

/// Where a level line at that height runs inside the boundary.
void cut_at(const Elevation& rings, double height_m, std::vector<Interval>& intervals) {
  std::vector<double> crossings_m;
  for (const auto& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point2& a = ring[i];
      const Point2& b = ring[(i + 1) % ring.size()];
      if ((a.y() <= height_m) == (b.y() <= height_m)) continue;
      crossings_m.push_back(a.x() + (height_m - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
  }
  std::sort(crossings_m.begin(), crossings_m.end());
  for (std::size_t i = 1; i < crossings_m.size(); i += 2) intervals.push_back({crossings_m[i - 1], crossings_m[i]});
}

PlanWall wall_of(const ExportPlane& plane, const PlanAxes& frame, const std::optional<double>& floor_m) {
  const Eigen::Vector3d& n = plane.record.plane.normal();
  const Eigen::Vector3d level_normal = (n - n.dot(frame.up) * frame.up).normalized();
  const Eigen::Vector3d along = frame.up.cross(level_normal);
  PlanWall wall;
  wall.id = plane.record.id;
  wall.normal = frame.to_plan(level_normal);

  const Elevation rings = elevation_of(plane, frame, along);
  std::vector<Interval> extent;
  for (const auto& ring : rings) {
    const auto ends =
        std::minmax_element(ring.begin(), ring.end(), [](const Point2& a, const Point2& b) { return a.x() < b.x(); });
    extent.push_back({ends.first->x(), ends.second->x()});
  }
  std::vector<Interval> standing;
  if (floor_m) {
    const auto cuts = std::lround((kCutHighM - kCutLowM) / kCutStepM);
    for (long i = 0; i <= cuts; ++i) {
      cut_at(rings, *floor_m + kCutLowM + static_cast<double>(i) * kCutStepM, standing);
    }
  } else {
    standing = extent;  // without a floor no height is known to cut at
  }
  const Eigen::Vector3d& c = plane.record.centroid_m;
  const auto segments = [&](const std::vector<Interval>& intervals) {
    std::vector<PlanSegment> result;
    for (const Interval& interval : joined(intervals)) {
      const auto point = [&](double at_m) { return frame.to_plan(c + (at_m - c.dot(along)) * along); };
      result.push_back({point(interval.from_m), point(interval.to_m)});
    }
    return result;
  };
  wall.standing = segments(standing);
  wall.extent = segments(extent);
  return wall;
}

void set_bounds(FloorPlan& plan) {
  Point2 min_m = Point2::Constant(std::numeric_limits<double>::infinity());
  Point2 max_m = -min_m;
  const auto include = [&](const Point2& p) {
    min_m = min_m.cwiseMin(p);
    max_m = max_m.cwiseMax(p);
  };
  for (const PlanArea& area : plan.areas) {
    for (const auto& ring : area.rings) std::for_each(ring.begin(), ring.end(), include);
  }
  for (const PlanWall& wall : plan.walls) {
    for (const PlanSegment& segment : wall.extent) {
      include(segment.from);
      include(segment.to);
    }
  }
  if (min_m.x() > max_m.x()) return;
  plan.min_m = min_m;
  plan.max_m = max_m;
}

}  // namespace

FloorPlan floor_plan_of(const ExportMap& map) {
  const Eigen::Vector3d down = map.gravity.value_or(-Eigen::Vector3d::UnitZ());
  const std::vector<PlaneClass> classes = classes_of(map, down);
  const std::optional<double> floor_m = floor_height_m(map, classes, -down);
  FloorPlan plan;
  plan.frame = axes_of(map, classes, -down);
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const ExportPlane& plane = map.planes[i];
    if (plane.outline.polygons.empty() || classes[i] == PlaneClass::kCeiling) continue;
    if (classes[i] == PlaneClass::kWall) {
      plan.walls.push_back(wall_of(plane, plan.frame, floor_m));
    } else {
      plan.areas.push_back(area_of(plane, classes[i], plan.frame));
    }
  }
  std::stable_sort(plan.areas.begin(), plan.areas.end(),
                   [](const PlanArea& a, const PlanArea& b) { return a.height_m < b.height_m; });
  set_bounds(plan);
  return plan;
}

}  // namespace planemap

#include "planemap/query/floorplan.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/polygon/polygon.hpp>
#include <cmath>
#include <limits>

#include "query/argument_checks.hpp"
#include "query/clip.hpp"
#include "query/queries.hpp"
#include "sort_unique.hpp"

namespace planemap {

namespace {

namespace bp = boost::polygon;
using PlanSet = bp::polygon_set_data<int>;
using PlanPolygon = bp::polygon_with_holes_data<int>;
using PlanPoint = bp::point_data<int>;
using Rings = std::vector<Ring>;

constexpr double kUnitM = 1e-3;     // of whole-numbered plan coordinates, with which sets of polygons are exact
constexpr double kFarthestM = 1e6;  // what is farther from the first floor is drawn there

std::optional<Error> check_heights(const char* low_name, double low_m, const char* high_name, double high_m) {
  if (!std::isfinite(low_m) || low_m < 0.0) {
    return Error{std::string(low_name) + ": must be finite and at least 0, is " + text_of(low_m)};
  }
  if (std::isfinite(high_m) && high_m > low_m) return std::nullopt;
  return Error{std::string(high_name) + ": must be finite and greater than " + low_name + "'s " + text_of(low_m) +
               ", is " + text_of(high_m)};
}

std::optional<Error> check(const FloorplanQuery& query, const MapSnapshot& snapshot) {
  if (auto error = check_heights("cut_low_m", query.cut_low_m, "cut_high_m", query.cut_high_m)) return error;
  if (auto error = check_heights("clear_low_m", query.clear_low_m, "clear_high_m", query.clear_high_m)) return error;
  if (auto error = check_length("wall_thickness_m", query.wall_thickness_m)) return error;
  return check_filter(query.filter, snapshot);
}

PlanAxes axes_of(const QueryIndex& index, const std::vector<const DescribedPlane*>& walls) {
  std::vector<SizedWall> sized;
  sized.reserve(walls.size());
  for (const DescribedPlane* wall : walls) sized.push_back({wall->record->plane.normal(), wall->outline->area_m2});
  return plan_axes(*index.up, sized);
}

/// Between plan coordinates and whole numbers of units from an origin.
class PlanRaster {
 public:
  explicit PlanRaster(const Eigen::Vector2d& origin_m) : origin_m_(origin_m) {}

  PlanPoint point(const Eigen::Vector2d& p_m) const {
    const auto unit = [](double at_m) {
      return static_cast<int>(std::lround(std::clamp(at_m, -kFarthestM, kFarthestM) / kUnitM));
    };
    return {unit(p_m.x() - origin_m_.x()), unit(p_m.y() - origin_m_.y())};
  }
  bp::polygon_data<int> polygon(const Ring& ring) const {
    std::vector<PlanPoint> points;
    points.reserve(ring.size());
    for (const Eigen::Vector2d& p_m : ring) points.push_back(point(p_m));
    bp::polygon_data<int> polygon;
    polygon.set(points.begin(), points.end());
    return polygon;
  }
  /// The polygons of a set, without those of less than an area.
  std::vector<Polygon> polygons_of(const PlanSet& set, double least_m2) const {
    std::vector<PlanPolygon> found;
    set.get(found);
    std::vector<Polygon> polygons;
    for (const PlanPolygon& outer : found) {
      Polygon polygon{ring_of(outer, 1.0), {}};
      for (auto hole = outer.begin_holes(); hole != outer.end_holes(); ++hole) {
        polygon.holes.push_back(ring_of(*hole, -1.0));
      }
      if (area_m2(std::span(&polygon, 1)) >= least_m2) polygons.push_back(std::move(polygon));
    }
    std::stable_sort(polygons.begin(), polygons.end(), [](const Polygon& a, const Polygon& b) {
      return area_m2(std::span(&a, 1)) > area_m2(std::span(&b, 1));
    });
    return polygons;
  }

 private:
  /// @param turn  1: counter-clockwise, -1: clockwise
  template <class RasterRing>
  Ring ring_of(const RasterRing& raster, double turn) const {
    Ring ring;
    for (const auto& p : raster) ring.emplace_back(origin_m_ + kUnitM * Eigen::Vector2d(p.x(), p.y()));
    if (turn * signed_area_m2(ring) < 0.0) std::reverse(ring.begin(), ring.end());
    return ring;
  }

  Eigen::Vector2d origin_m_;
};

/// What of a wall stands between two heights, as strips in the plan.
Rings strips_of(const DescribedPlane& wall, const PlanAxes& axes, double low_m, double high_m, double thickness_m) {
  const PlaneBasis& basis = wall.outline->basis;
  Rings rings = rings_of(wall.outline->polygons);
  const Eigen::Vector2d rise(axes.up.dot(basis.axis_u), axes.up.dot(basis.axis_v));
  const double origin_height_m = axes.up.dot(basis.origin_m);
  clip(rings, HalfPlane{rise, high_m - origin_height_m});
  clip(rings, HalfPlane{-rise, origin_height_m - low_m});
  const Eigen::Vector3d& n = wall.record->plane.normal();
  const Eigen::Vector3d level_normal = (n - n.dot(axes.up) * axes.up).normalized();
  const Eigen::Vector3d along = axes.up.cross(level_normal);
  std::vector<Interval> intervals;
  for (const Ring& ring : rings) {
    Interval& interval = intervals.emplace_back(
        Interval{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()});
    for (const Eigen::Vector2d& uv_m : ring) {
      const double at_m = along.dot(basis.to_world(uv_m));
      interval.from_m = std::min(interval.from_m, at_m);
      interval.to_m = std::max(interval.to_m, at_m);
    }
  }
  Rings strips;
  const Eigen::Vector3d& c = basis.origin_m;
  const Eigen::Vector2d inwards_m = -thickness_m * axes.to_plan(level_normal);
  for (const Interval& interval : joined(intervals)) {
    const Eigen::Vector2d from = axes.to_plan(c + (interval.from_m - c.dot(along)) * along);
    const Eigen::Vector2d to = axes.to_plan(c + (interval.to_m - c.dot(along)) * along);
    strips.push_back({from, to, to + inwards_m, from + inwards_m});
  }
  return strips;
}

/// Adds the polygons of a surface as they are seen from above.
void add_surface(const DescribedPlane& plane, const PlanAxes& axes, const PlanRaster& raster, PlanSet& set) {
  const auto seen = [&](const Ring& ring) {
    Ring projected;
    for (const Eigen::Vector2d& uv_m : ring) projected.push_back(axes.to_plan(plane.outline->basis.to_world(uv_m)));
    return raster.polygon(projected);
  };
  for (const Polygon& polygon : plane.outline->polygons) {
    set.insert(seen(polygon.outer));
    for (const Ring& hole : polygon.holes) set.insert(seen(hole), true);
  }
}

/// Squares of a cell's size where dense cells lie over a floor, between two heights.
PlanSet obstacles_over(const QueryIndex& index, const DescribedPlane& floor, const PlanAxes& axes,
                       const PlanRaster& raster, const FloorplanQuery& query) {
  // Cells above each other make one square: they are counted on a raster of half a cell.
  const double step_m = 0.5 * index.snapshot->cell_size_m();
  Eigen::AlignedBox3d above;
  for (const Polygon& polygon : floor.outline->polygons) {
    for (const Eigen::Vector2d& uv_m : polygon.outer) {
      const Eigen::Vector3d p_m = floor.outline->basis.to_world(uv_m);
      above.extend(p_m + query.clear_low_m * floor.record->plane.normal());
      above.extend(p_m + query.clear_high_m * floor.record->plane.normal());
    }
  }
  const Eigen::Vector3d margin_m = Eigen::Vector3d::Constant(2.0 * step_m);  // half a square, and the raster's step
  above = {above.min() - margin_m, above.max() + margin_m};
  std::vector<std::pair<std::int64_t, std::int64_t>> columns;
  index.visit_cells(above, [&](const CellView& cell) {
    const double height_m = floor.record->plane.signed_distance_m(cell.centre_m);
    if (height_m < query.clear_low_m || height_m > query.clear_high_m) return;
    const Eigen::Vector2d p = axes.to_plan(cell.centre_m) / step_m;
    columns.emplace_back(std::llround(p.x()), std::llround(p.y()));
  });
  sort_unique(columns);
  PlanSet set;
  const Eigen::Vector2d half_m = Eigen::Vector2d::Constant(step_m);
  for (const auto& [x, y] : columns) {
    const Eigen::Vector2d centre_m = step_m * Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y));
    const PlanPoint low = raster.point(centre_m - half_m);
    const PlanPoint high = raster.point(centre_m + half_m);
    set.insert(bp::rectangle_data<int>(low.x(), low.y(), high.x(), high.y()));
  }
  return set;
}

/// What of a wall is cut, with the rectangle around it.
struct PlanStrip {
  bp::polygon_data<int> polygon;
  bp::rectangle_data<int> extent;
};

/// The strips that may touch a set: all of them would make each floor's work grow with the map.
PlanSet strips_beside(const std::vector<PlanStrip>& strips, PlanSet& set) {
  PlanSet beside;
  bp::rectangle_data<int> extent;
  if (!set.extents(extent)) return beside;
  for (const PlanStrip& strip : strips) {
    if (bp::intersects(strip.extent, extent)) beside.insert(strip.polygon);
  }
  return beside;
}

std::vector<const DescribedPlane*> planes_of(const QueryIndex& index, const FilterTest& filter, PlaneClass wanted) {
  std::vector<const DescribedPlane*> found;
  for (std::size_t i = 0; i < index.planes.size(); ++i) {
    const DescribedPlane& plane = index.planes[i];
    if (plane.plane_class == wanted && !plane.outline->polygons.empty() && filter.passes(i)) found.push_back(&plane);
  }
  return found;
}

}  // namespace

Expected<Floorplan> floorplan_of(const QueryIndex& index, const FloorplanQuery& query) {
  using namespace boost::polygon::operators;
  if (auto error = check(query, *index.snapshot)) return failure(error);
  if (!index.up) return fail("floorplan: which way is down is not known (map.gravity)");
  const FilterTest filter(index, query.filter);
  const auto floors = planes_of(index, filter, PlaneClass::kFloor);
  if (floors.empty()) return fail("floorplan: no floor was seen that passes the filter");
  const auto walls = planes_of(index, filter, PlaneClass::kWall);

  Floorplan plan;
  plan.axes = axes_of(index, walls);
  plan.floor_height_m = std::numeric_limits<double>::infinity();
  for (const DescribedPlane* floor : floors) {
    plan.floor_height_m = std::min(plan.floor_height_m, plan.axes.up.dot(floor->record->centroid_m));
  }
  const PlanRaster raster(plan.axes.to_plan(floors.front()->record->centroid_m));
  std::vector<PlanStrip> strips;
  PlanSet wall_set;
  for (const DescribedPlane* wall : walls) {
    for (const Ring& strip : strips_of(*wall, plan.axes, plan.floor_height_m + query.cut_low_m,
                                       plan.floor_height_m + query.cut_high_m, query.wall_thickness_m)) {
      strips.push_back({raster.polygon(strip), {}});
      bp::extents(strips.back().extent, strips.back().polygon);
      wall_set.insert(strips.back().polygon);
    }
  }
  PlanSet floor_set;
  PlanSet free_set;
  for (const DescribedPlane* floor : floors) {
    PlanSet piece;
    add_surface(*floor, plan.axes, raster, piece);
    floor_set.insert(piece);
    piece -= obstacles_over(index, *floor, plan.axes, raster, query);
    piece -= strips_beside(strips, piece);
    free_set.insert(piece);
  }
  const double cell_m2 = index.snapshot->cell_size_m() * index.snapshot->cell_size_m();
  plan.walls = raster.polygons_of(wall_set, 0.0);
  plan.floor = raster.polygons_of(floor_set, cell_m2);
  plan.free_floor = raster.polygons_of(free_set, cell_m2);
  plan.free_area_m2 = area_m2(plan.free_floor);
  return plan;
}

}  // namespace planemap

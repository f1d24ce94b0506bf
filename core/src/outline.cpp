#define BOOST_ALLOW_DEPRECATED_HEADERS  // Boost.Geometry 1.74 includes some of Boost's own, with a message for each.

#include "planemap/outline.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/geometry/algorithms/area.hpp>
#include <boost/geometry/algorithms/correct.hpp>
#include <boost/geometry/algorithms/is_valid.hpp>
#include <boost/geometry/algorithms/simplify.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <boost/polygon/polygon.hpp>
#include <cmath>
#include <complex>

#include "square_cover.hpp"

namespace planemap {
namespace {

namespace bg = boost::geometry;
namespace bp = boost::polygon;

using RasterSet = bp::polygon_90_set_data<int>;
using RasterPolygon = bp::polygon_90_with_holes_data<int>;
using GeoPoint = bg::model::d2::point_xy<double>;
using GeoPolygon = bg::model::polygon<GeoPoint, /*ClockWise=*/false, /*Closed=*/true>;

// Raster steps to a cell's edge: fine enough that rounding (1/32 of a cell) is lost beside the quarter of a cell to
// which outlines are simplified.
constexpr int kStepsPerCell = 16;
constexpr int kHalfCell = kStepsPerCell / 2;
// Closing: squares grow by half a cell on each side, so that a gap of less than a cell between two of them is bridged.
constexpr int kClosing = kStepsPerCell / 2;
// A surface ends somewhere in its border cells, which leaves them points on one side only: their centres, means of
// those points, lie a quarter of a cell further inside than centres of full cells, on average. So "centre and half a
// cell" reaches a quarter of a cell beyond the true border, and so much is taken off again. Measured on rectangles at
// random angles and places (outline_test, AreaIsUnbiased).
constexpr int kInset = kStepsPerCell / 4;

constexpr double kSimplifyCells = 0.25;
// Steps of a staircase are up to a cell high, or a little more where a cell is missing: with this tolerance its line
// remains.
constexpr double kDirectionCells = 1.5;
constexpr double kStaircaseRad = 0.02;  // below it a border of a few metres has but one or two steps

using RasterPoints = std::vector<std::array<int, 2>>;

/// @param uv_m  points on the plane, in the axes of the raster
RasterPoints raster_of(std::span<const Eigen::Vector2d> uv_m, double step_m) {
  RasterPoints points;
  points.reserve(uv_m.size());
  for (const Eigen::Vector2d& uv : uv_m) {
    points.push_back({static_cast<int>(std::lround(uv.x() / step_m)), static_cast<int>(std::lround(uv.y() / step_m))});
  }
  return points;
}

/// The union of rectangles, each grown by `grown` steps on all sides, and the union then shrunk.
std::vector<RasterPolygon> union_of(std::span<const RasterRectangle> rectangles, int grown, int shrunk) {
  RasterSet set;
  for (const RasterRectangle& r : rectangles) {
    set.insert(bp::rectangle_data<int>(r.left - grown, r.bottom - grown, r.right + grown, r.top + grown));
  }
  if (shrunk > 0) set.shrink(shrunk, shrunk, shrunk, shrunk);
  std::vector<RasterPolygon> polygons;
  set.get(polygons);
  return polygons;
}

/// The closed and inset union of the cells' squares. Growing a union of squares is the union of grown squares.
std::vector<RasterPolygon> closed_squares(const RasterPoints& centres) {
  return union_of(square_cover(centres, kHalfCell + kClosing), 0, kClosing + kInset);
}

/// About the same, from bins of a cell's size instead of squares about the centres: good for the direction of the
/// border, in a tenth of the time.
std::vector<RasterPolygon> rough_squares(const RasterPoints& centres) {
  return union_of(occupied_rows(centres, kStepsPerCell), kClosing, 0);
}

/// Appends a Boost.Polygon ring to a Boost.Geometry one and closes it.
template <class RasterRing>
void append_ring(const RasterRing& ring, double step_m, bg::model::ring<GeoPoint, false, true>& out) {
  for (auto it = ring.begin(); it != ring.end(); ++it) out.push_back(GeoPoint((*it).x() * step_m, (*it).y() * step_m));
  if (!out.empty()) out.push_back(out.front());
}

GeoPolygon polygon_of(const RasterPolygon& raster, double step_m) {
  GeoPolygon polygon;
  append_ring(raster, step_m, polygon.outer());
  for (auto hole = raster.begin_holes(); hole != raster.end_holes(); ++hole) {
    polygon.inners().emplace_back();
    append_ring(*hole, step_m, polygon.inners().back());
  }
  bg::correct(polygon);  // outer counter-clockwise, holes clockwise
  return polygon;
}

/// Fewer corners, at most tolerance_m away. Where that breaks a polygon (rings that cross), a smaller tolerance is
/// tried, and at last it stays as it was.
GeoPolygon simplified(const GeoPolygon& polygon, double tolerance_m) {
  for (const double share : {1.0, 0.5, 0.25}) {
    GeoPolygon simple;
    bg::simplify(polygon, simple, share * tolerance_m);
    auto& holes = simple.inners();
    holes.erase(std::remove_if(holes.begin(), holes.end(), [](const auto& hole) { return hole.size() < 4; }),
                holes.end());
    if (bg::is_valid(simple)) return simple;
  }
  return polygon;
}

/// The direction, modulo a right angle, along which most of the border runs: argument of the sum of the sides' squared
/// lengths times exp(4i angle), radians, in -pi/4 .. pi/4. Squared, since one long side says more than many teeth.
double main_direction_rad(const std::vector<GeoPolygon>& polygons, double tolerance_m) {
  std::complex<double> sum;
  for (const GeoPolygon& polygon : polygons) {
    bg::model::ring<GeoPoint, false, true> ring;
    bg::simplify(polygon.outer(), ring, tolerance_m);
    for (std::size_t i = 1; i < ring.size(); ++i) {
      const std::complex<double> side(ring[i].x() - ring[i - 1].x(), ring[i].y() - ring[i - 1].y());
      sum += std::polar(std::norm(side), 4.0 * std::arg(side));
    }
  }
  return std::arg(sum) / 4.0;
}

std::vector<GeoPolygon> polygons_of(const std::vector<RasterPolygon>& rasters, double step_m) {
  std::vector<GeoPolygon> polygons;
  polygons.reserve(rasters.size());
  for (const RasterPolygon& raster : rasters) polygons.push_back(polygon_of(raster, step_m));
  return polygons;
}

Ring ring_of(const bg::model::ring<GeoPoint, false, true>& closed, const Eigen::Rotation2Dd& R_plane_raster) {
  Ring ring;
  if (closed.empty()) return ring;
  ring.reserve(closed.size() - 1);
  for (std::size_t i = 0; i + 1 < closed.size(); ++i) {
    ring.emplace_back(R_plane_raster * Eigen::Vector2d(closed[i].x(), closed[i].y()));
  }
  return ring;
}

}  // namespace

PlaneBasis basis_of(const Plane& plane, const Eigen::Vector3d& centroid_m) {
  const Eigen::Vector3d& n = plane.normal();
  // axis_u level and axis_v upwards for anything like a wall: borders of rooms then run along the axes. Near the
  // vertical, where "level" is no direction any more, axis_u goes by the world's x.
  const Eigen::Vector3d u =
      std::abs(n.z()) < 0.9 ? Eigen::Vector3d::UnitZ().cross(n) : Eigen::Vector3d(Eigen::Vector3d::UnitX() - n.x() * n);
  PlaneBasis basis;
  basis.origin_m = centroid_m - plane.signed_distance_m(centroid_m) * n;
  basis.axis_u = u.normalized();
  basis.axis_v = n.cross(basis.axis_u);
  return basis;
}

Outline outline_of(const Plane& plane, const Eigen::Vector3d& centroid_m,
                   std::span<const Eigen::Vector3d> cell_centres_m, double cell_size_m) {
  Outline outline;
  outline.basis = basis_of(plane, centroid_m);
  const double step_m = cell_size_m / kStepsPerCell;
  std::vector<Eigen::Vector2d> uv_m;
  uv_m.reserve(cell_centres_m.size());
  for (const Eigen::Vector3d& centre_m : cell_centres_m) uv_m.push_back(outline.basis.to_plane(centre_m));

  // A border that runs at an angle to the squares would become a staircase: lay the squares along it.
  Eigen::Rotation2Dd R_plane_raster = Eigen::Rotation2Dd::Identity();
  const double direction_rad =
      main_direction_rad(polygons_of(rough_squares(raster_of(uv_m, step_m)), step_m), kDirectionCells * cell_size_m);
  if (std::abs(direction_rad) > kStaircaseRad) {
    R_plane_raster.angle() = direction_rad;
    for (Eigen::Vector2d& centre : uv_m) centre = R_plane_raster.inverse() * centre;
  }
  std::vector<GeoPolygon> polygons = polygons_of(closed_squares(raster_of(uv_m, step_m)), step_m);
  std::stable_sort(polygons.begin(), polygons.end(),
                   [](const GeoPolygon& a, const GeoPolygon& b) { return bg::area(a) > bg::area(b); });
  for (const GeoPolygon& detailed : polygons) {
    outline.area_m2 += bg::area(detailed);
    const GeoPolygon simple = simplified(detailed, kSimplifyCells * cell_size_m);
    Polygon& polygon = outline.polygons.emplace_back();
    polygon.outer = ring_of(simple.outer(), R_plane_raster);
    for (const auto& hole : simple.inners()) polygon.holes.push_back(ring_of(hole, R_plane_raster));
  }
  return outline;
}

double signed_area_m2(const Ring& ring) {
  double twice_m2 = 0.0;
  for (std::size_t i = 2; i < ring.size(); ++i) {
    const Eigen::Vector2d a = ring[i - 1] - ring[0];
    const Eigen::Vector2d b = ring[i] - ring[0];
    twice_m2 += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice_m2;
}

double area_m2(std::span<const Polygon> polygons) {
  double area = 0.0;
  for (const Polygon& polygon : polygons) {
    area += signed_area_m2(polygon.outer);
    for (const Ring& hole : polygon.holes) area += signed_area_m2(hole);
  }
  return area;
}

}  // namespace planemap

#include "export/mesh.hpp"

#include <boost/polygon/polygon.hpp>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace planemap {
namespace {

namespace bp = boost::polygon;
using Point = bp::point_data<int>;
using SimplePolygon = bp::polygon_data<int>;
using PolygonSet = bp::polygon_set_data<int>;

constexpr double kUnitM = 1e-4;

SimplePolygon to_integers(const Ring& ring) {
  std::vector<Point> points;
  points.reserve(ring.size());
  for (const auto& uv_m : ring) {
    points.emplace_back(static_cast<int>(std::lround(uv_m.x() / kUnitM)),
                        static_cast<int>(std::lround(uv_m.y() / kUnitM)));
  }
  SimplePolygon polygon;
  polygon.set(points.begin(), points.end());
  return polygon;
}

/// Twice the area, positive for counter-clockwise corners.
std::int64_t turn(const Point& a, const Point& b, const Point& c) {
  const auto dx = [](const Point& from, const Point& to) { return std::int64_t{to.x()} - from.x(); };
  const auto dy = [](const Point& from, const Point& to) { return std::int64_t{to.y()} - from.y(); };
  return dx(a, b) * dy(a, c) - dy(a, b) * dx(a, c);
}

/// Collects triangles whose corners are shared.
class Collector {
 public:
  explicit Collector(const PlaneBasis& basis) : basis_(basis) {}

  void add(const Point& a, const Point& b, const Point& c) {
    const std::int64_t area = turn(a, b, c);
    if (area == 0) return;
    mesh_.triangles.push_back({index_of(a), index_of(area > 0 ? b : c), index_of(area > 0 ? c : b)});
  }
  PlaneMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t index_of(const Point& point) {
    const auto [entry, is_new] =
        indexes_.emplace(std::pair(point.x(), point.y()), static_cast<std::uint32_t>(mesh_.vertices_m.size()));
    if (is_new) mesh_.vertices_m.push_back(basis_.to_world(kUnitM * Eigen::Vector2d(point.x(), point.y())));
    return entry->second;
  }

  const PlaneBasis& basis_;
  std::map<std::pair<int, int>, std::uint32_t> indexes_;
  PlaneMesh mesh_;
};

}  // namespace

PlaneMesh mesh_of(const Outline& outline) {
  Collector collector(outline.basis);
  for (const Polygon& polygon : outline.polygons) {
    PolygonSet set;
    set.insert(to_integers(polygon.outer));
    for (const Ring& hole : polygon.holes) set.insert(to_integers(hole), /*is_hole=*/true);
    std::vector<SimplePolygon> trapezoids;
    set.get_trapezoids(trapezoids);
    for (const SimplePolygon& trapezoid : trapezoids) {
      const std::vector<Point> corners(trapezoid.begin(), trapezoid.end());
      for (std::size_t i = 2; i < corners.size(); ++i) collector.add(corners[0], corners[i - 1], corners[i]);
    }
  }
  return collector.take();
}

}  // namespace planemap

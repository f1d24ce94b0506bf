#pragma once

#define BOOST_ALLOW_DEPRECATED_HEADERS  // Boost.Geometry 1.74 includes some of Boost's own, with a message for each.

#include <Eigen/Core>
#include <boost/geometry/algorithms/correct.hpp>
#include <boost/geometry/algorithms/distance.hpp>
#include <boost/geometry/geometries/linestring.hpp>
#include <boost/geometry/geometries/multi_linestring.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <planemap/outline.hpp>

namespace planemap::testing {

/// An outline that is asked through Boost.Geometry: the twin of what core does itself.
class BoostSurface {
 public:
  using Point = boost::geometry::model::d2::point_xy<double>;
  using Polygon = boost::geometry::model::polygon<Point, /*ClockWise=*/false, /*Closed=*/true>;
  using Polygons = boost::geometry::model::multi_polygon<Polygon>;
  using Line = boost::geometry::model::linestring<Point>;

  explicit BoostSurface(const Outline& outline) {
    for (const auto& polygon : outline.polygons) {
      Polygon& copy = polygons_.emplace_back();
      add(polygon.outer, copy.outer());
      for (const Ring& hole : polygon.holes) add(hole, copy.inners().emplace_back());
      boost::geometry::correct(copy);
    }
  }

  const Polygons& polygons() const { return polygons_; }
  bool empty() const { return polygons_.empty(); }
  /// 0 within and on the border.
  double distance_m(const Eigen::Vector2d& uv_m) const {
    return boost::geometry::distance(Point(uv_m.x(), uv_m.y()), polygons_);
  }
  double border_distance_m(const Eigen::Vector2d& uv_m) const {
    return boost::geometry::distance(Point(uv_m.x(), uv_m.y()), borders_);
  }

 private:
  template <class BoostRing>
  void add(const Ring& ring, BoostRing& copy) {
    Line& line = borders_.emplace_back();
    for (const Eigen::Vector2d& p : ring) {
      copy.push_back(Point(p.x(), p.y()));
      line.push_back(Point(p.x(), p.y()));
    }
    line.push_back(line.front());
  }

  Polygons polygons_;
  boost::geometry::model::multi_linestring<Line> borders_;
};

}  // namespace planemap::testing

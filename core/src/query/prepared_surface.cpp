#include "query/prepared_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <planemap/query/limits.hpp>

namespace planemap {

PreparedSurface::PreparedSurface(const Outline& outline) : basis_(outline.basis) {
  for (const Polygon& polygon : outline.polygons) {
    add(polygon.outer);
    for (const Ring& hole : polygon.holes) add(hole);
  }
}

void PreparedSurface::add(const Ring& ring) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d step = ring[(i + 1) % ring.size()] - a;
    const double length2 = step.squaredNorm();
    edges_.push_back({a.x(), a.y(), step.x(), step.y(), length2 > 0.0 ? 1.0 / length2 : 0.0});
    uv_box_.extend(a);
    box_.extend(basis_.to_world(a));
  }
}

/// The nearest point of the border, and whether a line from the point crosses it an odd number of times.
struct PreparedSurface::Border {
  bool odd = false;
  double distance2_m2 = std::numeric_limits<double>::infinity();
  Eigen::Vector2d nearest_m = Eigen::Vector2d::Zero();
};

PreparedSurface::Border PreparedSurface::border(const Eigen::Vector2d& uv_m) const {
  Border border;
  for (const Edge& edge : edges_) {
    const double u = uv_m.x() - edge.u_m;
    const double v = uv_m.y() - edge.v_m;
    const double along = std::clamp((u * edge.du_m + v * edge.dv_m) * edge.inverse_length2, 0.0, 1.0);
    const double off_u = u - along * edge.du_m;
    const double off_v = v - along * edge.dv_m;
    const double distance2_m2 = off_u * off_u + off_v * off_v;
    if (distance2_m2 < border.distance2_m2) {
      border.distance2_m2 = distance2_m2;
      border.nearest_m = {uv_m.x() - off_u, uv_m.y() - off_v};
    }
    const bool spans = (edge.v_m <= uv_m.y()) != (edge.v_m + edge.dv_m <= uv_m.y());
    border.odd ^= spans && (u * edge.dv_m < v * edge.du_m) == (edge.dv_m > 0.0);
  }
  return border;
}

Spot PreparedSurface::spot(const Eigen::Vector2d& uv_m) const {
  const Border found = border(uv_m);
  if (found.odd || found.distance2_m2 <= kOnBorderM * kOnBorderM) return {true, 0.0, uv_m};
  return {false, std::sqrt(found.distance2_m2), found.nearest_m};
}

bool PreparedSurface::contains(const Eigen::Vector2d& uv_m) const {
  if (uv_box_.squaredExteriorDistance(uv_m) > kOnBorderM * kOnBorderM) return false;
  const Border found = border(uv_m);
  return found.odd || found.distance2_m2 <= kOnBorderM * kOnBorderM;
}

}  // namespace planemap

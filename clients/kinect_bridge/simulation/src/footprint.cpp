#include "footprint.hpp"

#include <algorithm>
#include <cmath>

namespace planemap::simulation {

Eigen::Vector2d Footprint::point_m(double along_x_m, double along_y_m) const {
  return centre_m + along_x_m * axis(0) + along_y_m * axis(1);
}

std::array<Eigen::Vector2d, 4> Footprint::corners_m() const {
  const double x = half_size_m.x();
  const double y = half_size_m.y();
  return {point_m(-x, -y), point_m(x, -y), point_m(x, y), point_m(-x, y)};
}

Footprint Footprint::grown(double margin_m) const {
  return {centre_m, half_size_m + Eigen::Vector2d::Constant(margin_m), direction};
}

double Footprint::distance_m(const Eigen::Vector2d& p_m) const {
  const Eigen::Vector2d offset_m = p_m - centre_m;
  const Eigen::Vector2d own_m(std::abs(offset_m.dot(axis(0))), std::abs(offset_m.dot(axis(1))));
  return (own_m - half_size_m).cwiseMax(0.0).norm();
}

bool overlap(const Footprint& a, const Footprint& b) {
  const auto corners_a = a.corners_m();
  const auto corners_b = b.corners_m();
  const auto apart_along = [&](const Eigen::Vector2d& axis) {
    const auto less = [&axis](const Eigen::Vector2d& p, const Eigen::Vector2d& q) { return p.dot(axis) < q.dot(axis); };
    const auto range_a = std::minmax_element(corners_a.begin(), corners_a.end(), less);
    const auto range_b = std::minmax_element(corners_b.begin(), corners_b.end(), less);
    return range_a.second->dot(axis) < range_b.first->dot(axis) || range_b.second->dot(axis) < range_a.first->dot(axis);
  };
  return !apart_along(a.axis(0)) && !apart_along(a.axis(1)) && !apart_along(b.axis(0)) && !apart_along(b.axis(1));
}

}  // namespace planemap::simulation

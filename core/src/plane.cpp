#include "planemap/plane.hpp"

#include <cmath>

namespace planemap {

Expected<Plane> Plane::from_coefficients(const Eigen::Vector3d& normal, double d) {
  const double length = normal.norm();
  if (!std::isfinite(length) || !std::isfinite(d)) return fail("plane: normal and d must be finite numbers");
  if (length < 1e-12) return fail("plane: the normal must not be zero");
  return Plane(normal / length, d / length);
}

Expected<Plane> Plane::from_unit_normal(const Eigen::Vector3d& unit_normal, double d) {
  constexpr double kTolerance = 1e-9;
  if (!(std::abs(unit_normal.norm() - 1.0) < kTolerance) || !std::isfinite(d)) {
    return fail("plane: the normal must be a unit vector, and d finite");
  }
  return Plane(unit_normal, d);
}

Plane Plane::through(const Eigen::Vector3d& point_m, const Eigen::Vector3d& unit_normal) {
  return {unit_normal, -unit_normal.dot(point_m)};
}

}  // namespace planemap

#include "planemap/plan.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>

namespace planemap {

PlanAxes plan_axes(const Eigen::Vector3d& up, std::span<const SizedWall> walls) {
  PlanAxes axes;
  axes.up = up;
  const Eigen::Vector3d reference = std::abs(up.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d x = (reference - reference.dot(up) * up).normalized();
  const Eigen::Vector3d y = up.cross(x);
  std::complex<double> sum;  // directions modulo a right angle
  for (const SizedWall& wall : walls) {
    sum += std::polar(wall.area_m2, 4.0 * std::atan2(wall.normal.dot(y), wall.normal.dot(x)));
  }
  const double turn_rad = std::arg(sum) / 4.0;
  axes.axis_x = std::cos(turn_rad) * x + std::sin(turn_rad) * y;
  axes.axis_y = up.cross(axes.axis_x);
  return axes;
}

std::vector<Interval> joined(std::vector<Interval> intervals) {
  constexpr double kClosedGapM = 0.12;
  std::sort(intervals.begin(), intervals.end(),
            [](const Interval& a, const Interval& b) { return a.from_m < b.from_m; });
  std::vector<Interval> result;
  for (const Interval& interval : intervals) {
    if (!result.empty() && interval.from_m <= result.back().to_m + kClosedGapM) {
      result.back().to_m = std::max(result.back().to_m, interval.to_m);
    } else {
      result.push_back(interval);
    }
  }
  return result;
}

}  // namespace planemap

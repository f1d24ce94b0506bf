#include "divider.hpp"

#include <limits>

namespace planemap {

simd::ScanPlane scan_plane(const Plane* plane, const ScanFrame& frame) {
  constexpr double kSigmas = 4.5;
  constexpr double kFloor_m = 0.015;
  simd::ScanPlane found;
  if (plane == nullptr) return found;
  if (plane->signed_distance_m(frame.T_world_sensor.translation()) <= 0.0) {
    found.d_cells = std::numeric_limits<float>::infinity();
    return found;
  }
  const double per_m = 1.0 / frame.cell_size_m;
  const Eigen::Vector3d corner_m = frame.base.cast<double>() * frame.cell_size_m;
  found.d_cells = static_cast<float>(plane->signed_distance_m(corner_m) * per_m);
  const Eigen::Vector3d along_sensor = frame.T_world_sensor.linear().transpose() * plane->normal();
  for (int k = 0; k < 3; ++k) {
    const double reach_cells = kSigmas * along_sensor(k) * per_m;
    found.normal[k] = static_cast<float>(plane->normal()(k));
    found.variance_factor[k] = static_cast<float>(reach_cells * reach_cells);
  }
  const double floor_cells = kFloor_m * per_m;
  const double pose_cells = kSigmas * kSigmas * frame.pose_variance_m2 * per_m * per_m;
  found.allowed_cells2 = static_cast<float>(floor_cells * floor_cells + pose_cells);
  return found;
}

}  // namespace planemap

#include "planemap/kinect_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace planemap {

KinectModel::KinectModel(const SensorConfig& config, double focal_length_px) {
  if (!std::isfinite(focal_length_px) || focal_length_px <= 0.0) {
    throw std::invalid_argument("KinectModel: focal_length_px must be finite and > 0");
  }
  const double quantisation = config.disparity_step_px / (focal_length_px * config.baseline_m * std::sqrt(12.0));
  depth_factor_ = std::hypot(config.depth_sigma_per_m, quantisation);
  lateral_factor_ = config.lateral_floor_px / focal_length_px;
}

double KinectModel::sigma_lateral_m(double offset_m, double depth_m) const {
  // offset / z * sigma_z = offset * z * factor: no division, so a depth of zero is no trap.
  return std::max(std::abs(offset_m) * depth_m * depth_factor_, lateral_factor_ * depth_m);
}

Eigen::Vector3d KinectModel::sigma_m(const Eigen::Vector3d& p_sensor_m) const {
  const double z_m = p_sensor_m.z();
  return {sigma_lateral_m(p_sensor_m.x(), z_m), sigma_lateral_m(p_sensor_m.y(), z_m), sigma_z_m(z_m)};
}

Eigen::Vector3d rotate_variances(const Eigen::Matrix3d& R_world_sensor, const Eigen::Vector3d& variance_sensor_m2) {
  return R_world_sensor.cwiseAbs2() * variance_sensor_m2;
}

}  // namespace planemap

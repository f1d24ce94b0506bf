#include "pose_noise.hpp"

#include <cmath>
#include <stdexcept>

namespace planemap::simulation {

PoseNoise::PoseNoise(const PoseNoiseConfig& config, const Random& random) : config_(config), random_(random) {
  const auto at_least_zero = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!at_least_zero(config.sigma_m) || !at_least_zero(config.sigma_rad) || !at_least_zero(config.correlation_s)) {
    throw std::invalid_argument("PoseNoiseConfig: sigma_m, sigma_rad and correlation_s must be >= 0");
  }
}

Eigen::Isometry3d PoseNoise::disturb(const Eigen::Isometry3d& T_world_sensor, double elapsed_s) {
  const bool wanders = started_ && config_.correlation_s > 0.0;
  const double kept = wanders ? std::exp(-elapsed_s / config_.correlation_s) : 0.0;
  for (double& value : state_) value = kept * value + std::sqrt(1.0 - kept * kept) * random_.gaussian();
  started_ = true;

  Eigen::Isometry3d error = Eigen::Isometry3d::Identity();
  error.translation() = config_.sigma_m * state_.head<3>();
  const Eigen::Vector3d rotation_rad = config_.sigma_rad * state_.tail<3>();
  const double angle_rad = rotation_rad.norm();
  if (angle_rad > 0.0) error.linear() = Eigen::AngleAxisd(angle_rad, rotation_rad / angle_rad).toRotationMatrix();
  return T_world_sensor * error;
}

}  // namespace planemap::simulation

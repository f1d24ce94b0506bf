#include "camera_sample.hpp"

#include <cmath>

namespace planemap::simulation {

CameraSample between(const CameraSample& a, const CameraSample& b, double share) {
  return {a.position_m + share * (b.position_m - a.position_m), a.yaw_rad + share * (b.yaw_rad - a.yaw_rad),
          a.pitch_rad + share * (b.pitch_rad - a.pitch_rad)};
}

Eigen::Isometry3d T_scene_sensor(const CameraSample& sample) {
  const double yaw_rad = sample.yaw_rad;
  const double pitch_rad = sample.pitch_rad;
  const Eigen::Vector3d forward(std::cos(yaw_rad) * std::cos(pitch_rad), std::sin(yaw_rad) * std::cos(pitch_rad),
                                std::sin(pitch_rad));
  const Eigen::Vector3d right(std::sin(yaw_rad), -std::cos(yaw_rad), 0.0);
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() << right, forward.cross(right), forward;
  transform.translation() = sample.position_m;
  return transform;
}

}  // namespace planemap::simulation

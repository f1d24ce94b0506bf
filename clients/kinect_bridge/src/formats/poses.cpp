// The formats that are poses.
#include "formats/field_formats.hpp"

namespace planemap::kinect_bridge {
namespace {

void put_quaternion(const Eigen::Isometry3d& T, double* wxyz) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(T.linear()).normalized();
  wxyz[0] = q.w();
  wxyz[1] = q.x();
  wxyz[2] = q.y();
  wxyz[3] = q.z();
}

}  // namespace

bot_core::rigid_transform_t to_rigid_transform(const Eigen::Isometry3d& T_world_body, std::int64_t utime) {
  bot_core::rigid_transform_t message{};
  message.utime = utime;
  Eigen::Map<Eigen::Vector3d>(message.trans) = T_world_body.translation();
  put_quaternion(T_world_body, message.quat);
  return message;
}

pronto::rigid_body_pose_cov_t to_pose_cov(const Eigen::Isometry3d& T_world_body, std::int64_t utime, double sigma_m,
                                          double sigma_rad) {
  pronto::rigid_body_pose_cov_t message{};
  message.utime = utime;
  Eigen::Map<Eigen::Vector3d>(message.xyz_pos) = T_world_body.translation();
  put_quaternion(T_world_body, message.quat);
  for (int i = 0; i < 6; ++i) {
    const double sigma = i < 3 ? sigma_rad : sigma_m;  // the rotation comes first
    message.pose_cov[7 * i] = sigma * sigma;
    message.active_indices[i] = 1;
  }
  return message;
}

}  // namespace planemap::kinect_bridge

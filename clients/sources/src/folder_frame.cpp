#include "folder_frame.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <utility>

#include "text_file.hpp"
#include "tum_trajectory.hpp"

namespace planemap::sources {
namespace {

constexpr double kMaxDeviation = 1e-3;  // of R^T R from the identity, each element; 7-Scenes has up to 4e-4
constexpr double kLastRowTolerance = 1e-6;

}  // namespace

std::optional<Eigen::Isometry3d> parse_rigid_transform(const std::string& text) {
  const auto numbers = parse_numbers(text);
  if (!numbers || numbers->size() != 16) return std::nullopt;
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers->data());
  if ((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > kLastRowTolerance) return std::nullopt;
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const Eigen::Matrix3d deviation = rotation.transpose() * rotation - Eigen::Matrix3d::Identity();
  // Written so that a NaN fails too.
  if (!(deviation.cwiseAbs().maxCoeff() <= kMaxDeviation) || rotation.determinant() <= 0.0) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = svd.matrixU() * svd.matrixV().transpose();
  transform.translation() = matrix.topRightCorner<3, 1>();
  return transform;
}

DepthScan make_depth_scan(DepthImage image, std::int64_t utime, const CameraParameters& camera, double depth_scale_m) {
  DepthScan scan;
  scan.utime = utime;
  scan.intrinsics = {image.width, image.height, camera.fx, camera.fy, camera.cx, camera.cy};
  scan.depth_scale_m = depth_scale_m;
  scan.depth = std::move(image.depth);
  return scan;
}

std::string objection_to(const FolderOptions& options) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (options.camera && (!positive(options.camera->fx) || !positive(options.camera->fy))) {
    return "the focal lengths of the intrinsics must be greater than 0";
  }
  if (options.depth_scale_m && !positive(*options.depth_scale_m)) return "the depth scale must be greater than 0";
  if (!(options.max_association_gap_s >= 0.0 && options.max_association_gap_s <= kMaxTumSeconds)) {
    return "the greatest time between a frame and its pose must be from 0 to 1e11 s";
  }
  return {};
}

}  // namespace planemap::sources

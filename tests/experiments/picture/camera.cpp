#include "picture/camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace planemap::experiments {

using namespace plot;

Camera::Camera(const Eigen::Vector3d& up, double azimuth_rad, double elevation_rad) {
  // The horizontal direction that azimuths count from: of the world axes the one that is least upright.
  int axis = 0;
  up.cwiseAbs().minCoeff(&axis);
  const Eigen::Vector3d east = (Eigen::Vector3d::Unit(axis) - up(axis) * up).normalized();
  const Eigen::Vector3d north = up.cross(east);
  const Eigen::Vector3d level = std::cos(azimuth_rad) * east + std::sin(azimuth_rad) * north;
  towards_ = std::cos(elevation_rad) * level + std::sin(elevation_rad) * up;
  right_ = up.cross(level).normalized();
  page_up_ = towards_.cross(right_);
}

PageFit::PageFit(const Camera& camera, std::span<const Eigen::Vector3d> points_m, const Box& box) : camera_(camera) {
  Eigen::Vector2d least = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d greatest = Eigen::Vector2d::Constant(-1e9);
  for (const Eigen::Vector3d& p_m : points_m) {
    least = least.cwiseMin(camera.project(p_m));
    greatest = greatest.cwiseMax(camera.project(p_m));
  }
  const Eigen::Vector2d size = (greatest - least).cwiseMax(1e-6);
  scale_ = std::min(box.width / size.x(), box.height / size.y());
  const Eigen::Vector2d middle = 0.5 * (least + greatest);
  offset_ = box.middle() - scale_ * Pixel(middle.x(), -middle.y());
}

Pixel PageFit::operator()(const Eigen::Vector3d& p_m) const {
  const Eigen::Vector2d p = camera_.project(p_m);
  return offset_ + scale_ * Pixel(p.x(), -p.y());
}

}  // namespace planemap::experiments

#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "plot/svg_page.hpp"

namespace planemap::experiments {

/// Looks at a scene from far away: an orthographic view.
class Camera {
 public:
  /// @param up             world frame, unit; upright on the page
  /// @param azimuth_rad    turn of the viewer about up, from a direction that depends on up alone
  /// @param elevation_rad  of the viewer above the horizon
  Camera(const Eigen::Vector3d& up, double azimuth_rad, double elevation_rad);

  /// Metres to the right and up the page.
  Eigen::Vector2d project(const Eigen::Vector3d& p_m) const { return {right_.dot(p_m), page_up_.dot(p_m)}; }
  /// Metres towards the viewer.
  double nearness(const Eigen::Vector3d& p_m) const { return towards_.dot(p_m); }
  /// Unit vector towards the viewer: surfaces with normals along it are seen.
  const Eigen::Vector3d& towards() const { return towards_; }

 private:
  Eigen::Vector3d right_;
  Eigen::Vector3d page_up_;
  Eigen::Vector3d towards_;
};

/// Places a camera's picture on a page: as large as a box allows, in its middle.
class PageFit {
 public:
  PageFit(const Camera& camera, std::span<const Eigen::Vector3d> points_m, const plot::Box& box);

  plot::Pixel operator()(const Eigen::Vector3d& p_m) const;
  double pixels_per_m() const { return scale_; }

 private:
  const Camera camera_;
  double scale_ = 1.0;
  plot::Pixel offset_ = plot::Pixel::Zero();
};

}  // namespace planemap::experiments

#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <planemap/scan.hpp>
#include <planemap/simulation/surface.hpp>
#include <span>
#include <vector>

namespace planemap::simulation {

/// What an ideal depth camera sees; row-major, width * height each.
struct RenderedImage {
  std::vector<float> depth_m;        ///< along z; 0: nothing
  std::vector<SurfaceId> surface;    ///< kNoSurface: nothing
  std::vector<float> cos_incidence;  ///< of the angle between line of sight and the surface's normal; 0: nothing
};

/// Renders surfaces by rasterising their polygons against a depth buffer. Surfaces show their free side only. One for
/// each thread.
class Renderer {
 public:
  /// Throws std::invalid_argument if the intrinsics are none of a camera.
  Renderer(std::span<const Surface> surfaces, const PinholeIntrinsics& intrinsics);

  /// Other surfaces from now on. Throws std::invalid_argument if they have more than 65,535 pieces.
  void show(std::span<const Surface> surfaces);

  /// What the camera sees from a pose; valid until the next call.
  const RenderedImage& render(const Eigen::Isometry3d& T_world_sensor);

 private:
  struct Face {
    ConvexPiece ring_m;  // world frame
    Eigen::Vector3d normal;
    double d_m;
    SurfaceId surface;
  };
  /// A face as the camera sees it: 1/z = at_origin + per_u * u + per_v * v over the pixels, -1/d of its plane.
  struct InverseDepth {
    double at_origin;
    double per_u;
    double per_v;
  };
  void draw(const Face& face, std::size_t face_index, const Eigen::Isometry3d& T_sensor_world);
  void clip_and_project(const Face& face, const Eigen::Isometry3d& T_sensor_world);
  void fill(const InverseDepth& inverse_depth, std::size_t face_index);
  void resolve();

  PinholeIntrinsics intrinsics_;
  std::vector<Face> faces_;
  std::vector<float> ray_length_;  // of (x, y, 1) through each pixel

  // Of the image being drawn; kept so that nothing is allocated for a frame.
  std::vector<float> inverse_depth_;       // 1/m; 0: nothing
  std::vector<std::uint16_t> face_index_;  // into faces_, where there is something
  std::vector<float> face_distance_m_;     // of the camera from each face's plane
  std::vector<Eigen::Vector3d> corners_sensor_m_;
  std::vector<Eigen::Vector2d> corners_px_;
  RenderedImage image_;
};

}  // namespace planemap::simulation

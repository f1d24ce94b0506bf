#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <planemap/scan.hpp>
#include <planemap/simulation/surface.hpp>
#include <span>

namespace planemap::simulation {

/// The nearest surface along a ray.
struct Hit {
  double along = std::numeric_limits<double>::infinity();  ///< in lengths of the ray's direction
  SurfaceId surface = kNoSurface;
  bool from_front = true;
};

/// A slow twin of the renderer: where a ray meets a convex piece, one piece after the other.
/// @param both_sides  whether a surface can be hit from behind, too
inline Hit cast_ray(std::span<const Surface> surfaces, const Eigen::Vector3d& origin_m,
                    const Eigen::Vector3d& direction, bool both_sides) {
  Hit nearest;
  for (const Surface& surface : surfaces) {
    const Eigen::Vector3d& normal = surface.plane.normal();
    const double approach = -normal.dot(direction);
    const double distance_m = surface.plane.signed_distance_m(origin_m);
    if (approach == 0.0 || (!both_sides && distance_m <= 0.0)) continue;
    const double along = distance_m / approach;
    if (along <= 0.0 || along >= nearest.along) continue;
    const Eigen::Vector3d p_m = origin_m + along * direction;
    for (const ConvexPiece& piece_m : surface.pieces_m) {
      bool inside = true;
      for (std::size_t i = 0; i < piece_m.size() && inside; ++i) {
        const Eigen::Vector3d edge_m = piece_m[(i + 1) % piece_m.size()] - piece_m[i];
        inside = edge_m.cross(p_m - piece_m[i]).dot(normal) >= 0.0;
      }
      if (inside) nearest = {along, surface.id, distance_m > 0.0};
    }
  }
  return nearest;
}

/// The ray through a pixel's centre, with z = 1 in the sensor frame: lengths along it are depths.
inline Eigen::Vector3d ray_through(const PinholeIntrinsics& intrinsics, int u, int v) {
  return {(u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy, 1.0};
}

/// A rectangle across the z axis of the world, its free side towards the origin.
inline Surface wall_at(SurfaceId id, double depth_m, double left_m, double right_m, double half_height_m) {
  Surface wall;
  wall.id = id;
  wall.plane = Plane::through({0.0, 0.0, depth_m}, -Eigen::Vector3d::UnitZ());
  wall.pieces_m = {{{left_m, -half_height_m, depth_m},
                    {left_m, half_height_m, depth_m},
                    {right_m, half_height_m, depth_m},
                    {right_m, -half_height_m, depth_m}}};
  return wall;
}

constexpr PinholeIntrinsics kKinect{640, 480, 585.0, 585.0, 320.0, 240.0};
constexpr PinholeIntrinsics kSmallKinect{80, 60, 73.125, 73.125, 40.0, 30.0};

}  // namespace planemap::simulation

#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <planemap/mapper.hpp>
#include <planemap/scan.hpp>
#include <random>
#include <vector>

namespace planemap::testing {

inline double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180.0 / M_PI;
}

/// A plane that a made-up room is rendered from: all of it, or the part where keep(point) holds.
struct Wall {
  Eigen::Vector3d normal;  ///< unit, towards the room
  double d;
  bool (*keep)(const Eigen::Vector3d&) = nullptr;
};

/// Sensor at a point that looks at another; the world's z is up.
inline Eigen::Isometry3d looking(const Eigen::Vector3d& from, const Eigen::Vector3d& at) {
  const Eigen::Vector3d z = (at - from).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << x, z.cross(x), z;
  T.translation() = from;
  return T;
}

/// Depth image of walls by casting a ray through each pixel: slow and obvious. Noise is Khoshelham's sigma_z times
/// noise_scale; depth is in units of 0.1 mm, so that its rounding does not matter.
inline DepthScan render(const std::vector<Wall>& walls, const Eigen::Isometry3d& T_world_sensor, std::uint64_t seed,
                        double noise_scale = 1.0, int width = 320, int height = 240) {
  DepthScan scan;
  scan.utime = static_cast<std::int64_t>(1'000'000 + seed * 33'333);
  const double f = 585.0 * width / 640.0;
  scan.intrinsics = {width, height, f, f, 0.5 * (width - 1), 0.5 * (height - 1)};
  scan.depth_scale_m = 1e-4;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const Eigen::Vector3d ray((u - scan.intrinsics.cx) / f, (v - scan.intrinsics.cy) / f, 1.0);
      const Eigen::Vector3d direction = T_world_sensor.linear() * ray;
      double z = std::numeric_limits<double>::infinity();
      for (const Wall& wall : walls) {
        const double slope = wall.normal.dot(direction);
        if (slope >= -1e-9) continue;  // seen from behind
        const double t = -(wall.normal.dot(T_world_sensor.translation()) + wall.d) / slope;
        if (t <= 0.0 || t >= z) continue;
        if (wall.keep != nullptr && !wall.keep(T_world_sensor.translation() + t * direction)) continue;
        z = t;
      }
      z += noise_scale * 1.425e-3 * z * z * normal(random);
      scan.depth.push_back(std::isfinite(z) && z > 0.0 && z < 6.5 ? static_cast<std::uint16_t>(std::lround(z / 1e-4))
                                                                  : 0);
    }
  }
  return scan;
}

/// The points of a depth image, in no order that tells of the image.
inline PointScan cloud_of(const DepthScan& scan) {
  PointScan cloud;
  cloud.utime = scan.utime;
  const PinholeIntrinsics& k = scan.intrinsics;
  const std::size_t size = scan.depth.size();
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t at = i * 7919 % size;  // 7919 divides no image's size
    if (scan.depth[at] == kNoReturn) continue;
    const double z = scan.depth[at] * scan.depth_scale_m;
    const double u = static_cast<double>(at % static_cast<std::size_t>(k.width));
    const double v = static_cast<double>(at / static_cast<std::size_t>(k.width));
    for (const double x : {(u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z}) {
      cloud.xyz_m.push_back(static_cast<float>(x));
    }
  }
  return cloud;
}

/// A room of a floor and three walls, open to one side.
inline const std::vector<Wall>& small_room() {
  static const std::vector<Wall> walls = {{{0, 0, 1}, 0.0}, {{-1, 0, 0}, 2.5}, {{0, -1, 0}, 2.0}, {{0, 1, 0}, 2.0}};
  return walls;
}

/// One more look around it.
/// @param turn_rad  of a step
inline void look(Mapper& mapper, int step, double turn_rad = 0.3) {
  const auto T = looking({-1.0, 0.0, 1.2}, {1.0, 1.5 * std::sin(turn_rad * step), 0.8});
  mapper.integrate(render(small_room(), T, static_cast<std::uint64_t>(step), 1.0, 160, 120), T);
}

/// The map after so many looks.
inline std::shared_ptr<const MapSnapshot> looked_around(std::uint64_t epoch, int looks,
                                                        const MapperConfig& config = {}) {
  Mapper mapper(config, epoch);
  for (int i = 0; i < looks; ++i) look(mapper, i);
  return mapper.snapshot();
}

}  // namespace planemap::testing

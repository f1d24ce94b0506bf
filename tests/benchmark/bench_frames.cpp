#include "bench_frames.hpp"

namespace planemap::benchmark {

namespace {

std::vector<float> world_points(const DepthScan& scan, const Eigen::Isometry3d& T_world_sensor,
                                const SensorConfig& sensor) {
  const PinholeIntrinsics& k = scan.intrinsics;
  std::vector<float> xyz_m;
  xyz_m.reserve(3 * scan.depth.size());
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const std::uint16_t depth = scan.depth[static_cast<std::size_t>(v * k.width + u)];
      const double z = depth * scan.depth_scale_m;
      if (depth == kNoReturn || depth == kNoReturnHigh || z < sensor.min_range_m || z > sensor.max_range_m) continue;
      const Eigen::Vector3d p = T_world_sensor * Eigen::Vector3d((u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z);
      xyz_m.insert(xyz_m.end(), {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
    }
  }
  return xyz_m;
}

}  // namespace

std::vector<BenchFrame> read_frames(sources::FrameSource& source, std::size_t most, const SensorConfig& sensor) {
  std::vector<BenchFrame> frames;
  while (frames.size() < most) {
    auto frame = source.next();
    if (!frame) break;
    auto points = world_points(frame->scan, frame->T_world_sensor, sensor);
    frames.push_back({std::move(frame->scan), frame->T_world_sensor, std::move(points)});
  }
  return frames;
}

}  // namespace planemap::benchmark

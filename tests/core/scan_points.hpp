#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <planemap/kinect_model.hpp>
#include <planemap/scan.hpp>
#include <vector>

namespace planemap::testing {

/// One uncertain point of a scan.
struct UncertainPoint {
  Eigen::Vector3d p_world_m;
  Eigen::Vector3d variance_sensor_m2;  ///< squared standard errors along the sensor's axes
};

/// The points of a scan one by one, as the equations say it: the slow twin of the assignment's kernels. Calls
/// visit(UncertainPoint) for each point that can be mapped, row by row, and returns where the others went.
template <class Visit>
PointCounts for_each_point(const DepthScan& scan, const Eigen::Isometry3d& T_world_sensor, const SensorConfig& config,
                           Visit&& visit);
template <class Visit>
PointCounts for_each_point(const PointScan& scan, const Eigen::Isometry3d& T_world_sensor, const SensorConfig& config,
                           Visit&& visit);

// Implementation.

template <class Visit>
PointCounts for_each_point(const DepthScan& scan, const Eigen::Isometry3d& T_world_sensor, const SensorConfig& config,
                           Visit&& visit) {
  const PinholeIntrinsics& k = scan.intrinsics;
  const KinectModel model(config, k.fx);
  const double depth_factor2 = model.depth_factor() * model.depth_factor();
  const double lateral_factor2 = model.lateral_factor() * model.lateral_factor();
  const Eigen::Matrix3d R = T_world_sensor.rotation();
  const Eigen::Vector3d origin = T_world_sensor.translation();
  PointCounts counts;
  counts.total = scan.depth.size();
  const std::uint16_t* depth = scan.depth.data();
  for (int v = 0; v < k.height; ++v) {
    const double y = (v - k.cy) / k.fy;
    const Eigen::Vector3d row = R.col(1) * y + R.col(2);
    for (int u = 0; u < k.width; ++u, ++depth) {
      if (*depth == kNoReturn || *depth == kNoReturnHigh) {
        ++counts.no_return;
        continue;
      }
      const double z = *depth * scan.depth_scale_m;
      if (z < config.min_range_m || z > config.max_range_m) {
        ++counts.out_of_range;
        continue;
      }
      const double x = (u - k.cx) / k.fx;
      const double z2 = z * z;
      const double depth_variance = depth_factor2 * z2 * z2;
      const double floor = lateral_factor2 * z2;
      ++counts.mapped;
      visit(UncertainPoint{
          origin + z * (R.col(0) * x + row),
          {std::max(x * x * depth_variance, floor), std::max(y * y * depth_variance, floor), depth_variance}});
    }
  }
  return counts;
}

template <class Visit>
PointCounts for_each_point(const PointScan& scan, const Eigen::Isometry3d& T_world_sensor, const SensorConfig& config,
                           Visit&& visit) {
  const KinectModel model(config, config.focal_length_px);
  PointCounts counts;
  counts.total = scan.xyz_m.size() / 3;
  for (std::size_t i = 0; i < counts.total; ++i) {
    const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3f>(&scan.xyz_m[3 * i]).cast<double>();
    if (!p.allFinite()) {
      ++counts.no_return;
      continue;
    }
    const double range = p.z();
    if (!(range >= config.min_range_m && range <= config.max_range_m)) {
      ++counts.out_of_range;
      continue;
    }
    Eigen::Vector3d sigma = model.sigma_m(p);
    if (!scan.sigma_m.empty()) {
      sigma = Eigen::Map<const Eigen::Vector3f>(&scan.sigma_m[3 * i]).cast<double>();
      if (!(sigma.allFinite() && sigma.minCoeff() >= 0.0)) {
        ++counts.invalid;
        continue;
      }
    }
    ++counts.mapped;
    visit(UncertainPoint{T_world_sensor * p, sigma.cwiseAbs2()});
  }
  return counts;
}

}  // namespace planemap::testing

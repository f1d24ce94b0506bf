#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <planemap/scan.hpp>
#include <vector>

#include "config/service_config.hpp"

namespace planemap::service {

/// How many points of a scan were turned into no returns.
struct FilteredPoints {
  std::size_t out_of_range = 0;  ///< outside the input's range limits
  std::size_t own_body = 0;      ///< inside a box of the body mask
};

/// One input's range limits and body mask.
class PointFilter {
 public:
  explicit PointFilter(const InputConfig& input);

  /// Turns points outside the limits and on the robot's own body into no returns.
  FilteredPoints apply(Scan& scan) const;

 private:
  FilteredPoints apply(DepthScan& scan) const;
  FilteredPoints apply(PointScan& scan) const;
  std::size_t mask_depth(DepthScan& scan) const;
  bool on_body(const Eigen::Vector3d& p_sensor_m) const;

  double min_range_m_;
  double max_range_m_;
  Eigen::Isometry3d T_body_sensor_ = Eigen::Isometry3d::Identity();
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< body frame, metres
};

}  // namespace planemap::service

#pragma once

#include <Eigen/Core>
#include <vector>

namespace planemap::experiments {

/// The points of many scans in one cloud, thinned out by PCL's VoxelGrid: each voxel keeps the mean of its points. Once
/// a scan, so that memory stays small, and once at the end.
class AccumulatedCloud {
 public:
  explicit AccumulatedCloud(double leaf_m) : leaf_m_(leaf_m) {}

  /// @param points_m  of one scan, world frame
  void add(const std::vector<Eigen::Vector3f>& points_m);
  /// One point a voxel, world frame, metres.
  std::vector<Eigen::Vector3f> points_m() const;

 private:
  double leaf_m_;
  std::vector<Eigen::Vector3f> thinned_m_;  ///< scan by scan
};

}  // namespace planemap::experiments

#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <planemap/config.hpp>
#include <planemap/scan.hpp>
#include <string>
#include <vector>

namespace planemap::benchmark {

/// A frame as each of the compared programs wants it; made before any time is taken.
struct BenchFrame {
  Scan scan;  ///< a DepthScan
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
  std::vector<float> xyz_world_m;  ///< x0 y0 z0 ... of the pixels whose depth is in range, world frame
};

/// What one frame took of a part.
struct PartTime {
  std::string name;
  double ms;      ///< by the clock
  double own_ms;  ///< the thread's own time
};
/// The first part is the whole; others are named "whole.part".
using PartTimes = std::vector<PartTime>;

/// Something that takes frames and whose time is measured.
class Contestant {
 public:
  virtual ~Contestant() = default;
  /// Takes one frame. What is not its own work (a cloud in its format) is done outside of the time it reports.
  virtual PartTimes take(const BenchFrame& frame) = 0;
};

/// All of planemap, from the depth image to the published snapshot.
/// @param name  of the whole; its stages are "name.stage"
std::unique_ptr<Contestant> make_planemap(const std::string& name, const MapperConfig& config, int threads = 1);
/// The floor: depth to sums of a geometric grid, written by hand, with nothing of the method.
std::unique_ptr<Contestant> make_reference(const SensorConfig& sensor, double cell_size_m);
std::unique_ptr<Contestant> make_pcl_voxel_grid(double leaf_m);
std::unique_ptr<Contestant> make_pcl_approximate_voxel_grid(double leaf_m);
std::unique_ptr<Contestant> make_pcl_organized_multi_plane(const SensorConfig& sensor);
std::unique_ptr<Contestant> make_octomap_endpoints(double resolution_m);

}  // namespace planemap::benchmark

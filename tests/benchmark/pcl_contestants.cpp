// PCL's own: down-sampling, and the planes of one frame. Without their headers' warnings: PCL is a system include.
#include <pcl/features/integral_image_normal.h>
#include <pcl/filters/approximate_voxel_grid.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/organized_multi_plane_segmentation.h>

#include <limits>

#include "common/stopwatch.hpp"
#include "contestant.hpp"

namespace planemap::benchmark {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/// The frame's points in the world, without those that have none.
Cloud::Ptr world_cloud(const BenchFrame& frame) {
  auto cloud = std::make_shared<Cloud>();
  cloud->reserve(frame.xyz_world_m.size() / 3);
  for (std::size_t i = 0; i < frame.xyz_world_m.size(); i += 3) {
    cloud->emplace_back(frame.xyz_world_m[i], frame.xyz_world_m[i + 1], frame.xyz_world_m[i + 2]);
  }
  return cloud;
}

/// The frame as PCL's organized methods want it: one point a pixel, sensor frame, NaN where there is none.
Cloud::Ptr organized_cloud(const DepthScan& scan, const SensorConfig& sensor) {
  const PinholeIntrinsics& k = scan.intrinsics;
  auto cloud = std::make_shared<Cloud>(static_cast<std::uint32_t>(k.width), static_cast<std::uint32_t>(k.height));
  cloud->is_dense = false;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const std::uint16_t depth = scan.depth[static_cast<std::size_t>(v * k.width + u)];
      const double z = depth * scan.depth_scale_m;
      const bool none =
          depth == kNoReturn || depth == kNoReturnHigh || z < sensor.min_range_m || z > sensor.max_range_m;
      (*cloud)(u, v) = none ? pcl::PointXYZ(kNone, kNone, kNone)
                            : pcl::PointXYZ(static_cast<float>((u - k.cx) / k.fx * z),
                                            static_cast<float>((v - k.cy) / k.fy * z), static_cast<float>(z));
    }
  }
  return cloud;
}

template <class Filter>
class DownSampling final : public Contestant {
 public:
  DownSampling(const char* name, double leaf_m) : name_(name) {
    const auto leaf = static_cast<float>(leaf_m);
    filter_.setLeafSize(leaf, leaf, leaf);
  }
  PartTimes take(const BenchFrame& frame) override {
    filter_.setInputCloud(world_cloud(frame));
    Cloud thinned;
    const Stopwatch whole;
    filter_.filter(thinned);
    return {{name_, whole.ms(), whole.own_ms()}};
  }

 private:
  const char* name_;
  Filter filter_;
};

/// Normals by integral images and connected planes: what PCL's documentation shows for a Kinect.
class OrganizedMultiPlane final : public Contestant {
 public:
  explicit OrganizedMultiPlane(const SensorConfig& sensor) : sensor_(sensor) {}

  PartTimes take(const BenchFrame& frame) override {
    const Cloud::Ptr cloud = organized_cloud(std::get<DepthScan>(frame.scan), sensor_);
    const Stopwatch whole;
    pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setNormalEstimationMethod(estimation.COVARIANCE_MATRIX);
    estimation.setMaxDepthChangeFactor(0.02F);
    estimation.setNormalSmoothingSize(20.0F);
    auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
    estimation.setInputCloud(cloud);
    estimation.compute(*normals);
    pcl::OrganizedMultiPlaneSegmentation<pcl::PointXYZ, pcl::Normal, pcl::Label> segmentation;
    segmentation.setMinInliers(1000);
    segmentation.setAngularThreshold(0.052);  // three degrees
    segmentation.setDistanceThreshold(0.02);
    segmentation.setInputNormals(normals);
    segmentation.setInputCloud(cloud);
    std::vector<pcl::PlanarRegion<pcl::PointXYZ>, Eigen::aligned_allocator<pcl::PlanarRegion<pcl::PointXYZ>>> regions;
    segmentation.segmentAndRefine(regions);
    return {{"pclOrganizedMultiPlane", whole.ms(), whole.own_ms()}};
  }

 private:
  SensorConfig sensor_;
};

}  // namespace

std::unique_ptr<Contestant> make_pcl_voxel_grid(double leaf_m) {
  return std::make_unique<DownSampling<pcl::VoxelGrid<pcl::PointXYZ>>>("pclVoxelGrid", leaf_m);
}

std::unique_ptr<Contestant> make_pcl_approximate_voxel_grid(double leaf_m) {
  return std::make_unique<DownSampling<pcl::ApproximateVoxelGrid<pcl::PointXYZ>>>("pclApproximateVoxelGrid", leaf_m);
}

std::unique_ptr<Contestant> make_pcl_organized_multi_plane(const SensorConfig& sensor) {
  return std::make_unique<OrganizedMultiPlane>(sensor);
}

}  // namespace planemap::benchmark

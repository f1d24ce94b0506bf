#include "real/accumulated_cloud.hpp"

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

namespace planemap::experiments {

namespace {

std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points_m, double leaf_m) {
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;
  if (points_m.empty()) return {};
  const auto cloud = std::make_shared<Cloud>();
  cloud->reserve(points_m.size());
  for (const Eigen::Vector3f& p : points_m) cloud->emplace_back(p.x(), p.y(), p.z());
  pcl::VoxelGrid<pcl::PointXYZ> filter;
  const auto leaf = static_cast<float>(leaf_m);
  filter.setLeafSize(leaf, leaf, leaf);
  filter.setInputCloud(cloud);
  Cloud kept;
  filter.filter(kept);
  std::vector<Eigen::Vector3f> result;
  result.reserve(kept.size());
  for (const pcl::PointXYZ& p : kept) result.emplace_back(p.x, p.y, p.z);
  return result;
}

}  // namespace

void AccumulatedCloud::add(const std::vector<Eigen::Vector3f>& points_m) {
  const std::vector<Eigen::Vector3f> scan_m = thinned(points_m, leaf_m_);
  thinned_m_.insert(thinned_m_.end(), scan_m.begin(), scan_m.end());
}

std::vector<Eigen::Vector3f> AccumulatedCloud::points_m() const {
  return thinned(thinned_m_, leaf_m_);
}

}  // namespace planemap::experiments

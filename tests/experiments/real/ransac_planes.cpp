#include "real/ransac_planes.hpp"

#include <pcl/ModelCoefficients.h>
#include <pcl/PointIndices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/sac_model_plane.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>
#include <iterator>
#include <numeric>

namespace planemap::experiments {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Segmentation = pcl::SACSegmentation<pcl::PointXYZ>;

Cloud::Ptr cloud_of(const std::vector<Eigen::Vector3f>& points_m) {
  auto cloud = std::make_shared<Cloud>();
  cloud->reserve(points_m.size());
  for (const Eigen::Vector3f& p : points_m) cloud->emplace_back(p.x(), p.y(), p.z());
  return cloud;
}

void set_up(Segmentation& segmentation, const Cloud::Ptr& cloud, const RansacConfig& config) {
  segmentation.setModelType(pcl::SACMODEL_PLANE);
  segmentation.setMethodType(pcl::SAC_RANSAC);
  segmentation.setOptimizeCoefficients(true);
  segmentation.setDistanceThreshold(config.distance_m);
  segmentation.setMaxIterations(config.max_iterations);
  segmentation.setProbability(config.probability);
  segmentation.setInputCloud(cloud);
}

/// PCL's own least squares over some points.
pcl::ModelCoefficients refit(const Cloud::Ptr& cloud, const pcl::Indices& inliers, const pcl::ModelCoefficients& from) {
  const pcl::SampleConsensusModelPlane<pcl::PointXYZ> model(cloud);
  const Eigen::Map<const Eigen::VectorXf> start(from.values.data(), 4);
  Eigen::VectorXf fitted;
  model.optimizeModelCoefficients(inliers, start, fitted);
  pcl::ModelCoefficients result;
  result.values.assign(fitted.data(), fitted.data() + 4);
  return result;
}

Plane plane_of(const pcl::ModelCoefficients& coefficients) {
  const auto& c = coefficients.values;
  return Plane::from_coefficients(Eigen::Vector3f(c[0], c[1], c[2]).cast<double>(), static_cast<double>(c[3])).value();
}

/// The largest connected part of some points.
pcl::Indices largest_cluster(const Cloud::Ptr& cloud, const pcl::Indices& of, double gap_m) {
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(gap_m);
  extraction.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  extraction.setInputCloud(cloud);
  extraction.setIndices(std::make_shared<pcl::Indices>(of));
  std::vector<pcl::PointIndices> clusters;  // largest first
  extraction.extract(clusters);
  return clusters.empty() ? of : clusters.front().indices;
}

}  // namespace

std::vector<RansacPlane> ransac_planes(const std::vector<Eigen::Vector3f>& cloud_m, const RansacConfig& config) {
  const Cloud::Ptr cloud = cloud_of(cloud_m);
  Segmentation segmentation;
  set_up(segmentation, cloud, config);
  const auto left = std::make_shared<pcl::Indices>(cloud_m.size());
  std::iota(left->begin(), left->end(), 0);
  std::vector<RansacPlane> planes;
  while (planes.size() < config.planes && left->size() > 3) {
    segmentation.setIndices(left);
    pcl::PointIndices inliers;
    pcl::ModelCoefficients coefficients;
    segmentation.segment(inliers, coefficients);
    if (inliers.indices.empty()) break;
    if (config.connected_within_m > 0.0) {
      inliers.indices = largest_cluster(cloud, inliers.indices, config.connected_within_m);
      if (inliers.indices.size() < 3) break;
      coefficients = refit(cloud, inliers.indices, coefficients);
    }
    std::sort(inliers.indices.begin(), inliers.indices.end());
    planes.push_back({plane_of(coefficients), {inliers.indices.begin(), inliers.indices.end()}});
    pcl::Indices rest;
    std::set_difference(left->begin(), left->end(), inliers.indices.begin(), inliers.indices.end(),
                        std::back_inserter(rest));
    *left = std::move(rest);
  }
  std::stable_sort(planes.begin(), planes.end(),
                   [](const RansacPlane& a, const RansacPlane& b) { return a.inliers.size() > b.inliers.size(); });
  return planes;
}

}  // namespace planemap::experiments

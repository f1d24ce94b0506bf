#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <planemap/plane.hpp>
#include <vector>

namespace planemap::experiments {

/// The paper's offline peer: planes of the accumulated cloud by RANSAC, one after the other, as PCL's tutorial does it
/// (SACSegmentation, SACMODEL_PLANE, optimised coefficients).
struct RansacConfig {
  double distance_m = 0.03;         ///< of an inlier to its plane, at most
  double connected_within_m = 0.0;  ///< a plane is its largest connected part, gaps up to this; 0: all its inliers
  int max_iterations = 5000;        ///< the red kitchen's planes depend on it: docs/experiments.md
  double probability = 0.99;        ///< of having tried a sample without outliers
  std::size_t planes = 15;          ///< as many as the paper compared
};

struct RansacPlane {
  Plane plane = Plane::through(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());  ///< the normal's side means nothing
  std::vector<std::uint32_t> inliers;                                               ///< places in the cloud, ascending
};

/// Planes, most inliers first, each fitted to its inliers (PCL's optimised coefficients). The inliers of a plane are
/// taken out of the cloud before the next is looked for. Deterministic: PCL draws its samples from a fixed seed.
std::vector<RansacPlane> ransac_planes(const std::vector<Eigen::Vector3f>& cloud_m, const RansacConfig& config);

}  // namespace planemap::experiments

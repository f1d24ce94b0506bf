#pragma once

#include <cstddef>
#include <cstdint>
#include <planemap/plane.hpp>
#include <planemap/plane_statistics.hpp>
#include <planemap/pose_covariance.hpp>
#include <planemap/pose_evidence.hpp>

namespace planemap {

/// What a mapper knows of a plane beside its record: all that another one needs to go on with it.
struct PlaneState {
  PlaneStatistics statistics{Eigen::Vector3d::Zero()};
  PlaneFit fit;
  PoseEvidence pose_evidence;
  std::size_t worn_cells = 0;          ///< that it has lost to wear, ever
  std::size_t cells_when_bridged = 0;  ///< how many it had when it last looked for pieces across a gap
  int scans_since_bridged = 0;         ///< that touched it
};

/// What a mapper knows beside cells and planes.
struct MapperState {
  PlaneId next_plane_id = 1;  ///< no plane had this id yet, or a greater one
  PoseCovariance last_pose = PoseCovariance::Zero();
  bool poses_err = false;         ///< some scan said so of its pose, or the configuration does
  double pose_variance_m2 = 0.0;  ///< what the poses' errors do to a point's distance to its plane: mean over the scans
  std::int64_t scans = 0;         ///< that it is the mean of
};

}  // namespace planemap

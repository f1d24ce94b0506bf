#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <planemap/plane.hpp>
#include <planemap/query/plane_filter.hpp>

namespace planemap {

/// Which surfaces are nearest to a point?
struct NearestQuery {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();        ///< world frame
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< of the point; sigma^2 I where all directions are alike
  std::size_t count = 1;                                    ///< planes, at most; 1 and more
  double max_distance_m = std::numeric_limits<double>::infinity();  ///< to the surface, >= 0
  PlaneFilter filter;
};

/// A plane near a point. Formulas: docs/queries.md.
struct NearPlane {
  PlaneId id = kNoPlane;
  double surface_distance_m = 0.0;  ///< to the nearest point within the boundary: what "near" goes by
  Eigen::Vector3d surface_point_m = Eigen::Vector3d::Zero();  ///< that point, world frame
  double signed_distance_m = 0.0;  ///< to the endless plane; > 0 on the side from which it was seen
  double sigma_m = 0.0;            ///< of the signed distance, by the covariances of plane and point
  double mahalanobis = 0.0;        ///< |signed distance| / sigma; of nothing known exactly 0 or infinity
  Eigen::Vector3d foot_m = Eigen::Vector3d::Zero();  ///< the point's projection on the endless plane, world frame
  bool foot_inside = false;                          ///< whether the foot lies within the boundary
};

}  // namespace planemap

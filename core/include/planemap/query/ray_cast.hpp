#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <planemap/plane.hpp>
#include <planemap/query/plane_filter.hpp>
#include <planemap/snapshot.hpp>

namespace planemap {

struct Ray {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();            ///< world frame
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();          ///< world frame, any length but 0
  double max_range_m = std::numeric_limits<double>::infinity();  ///< > 0
};

/// What rays may meet.
struct CastOptions {
  bool planes = true;
  bool cells = true;
  PlaneFilter filter;
};

/// Where a ray meets a plane within its boundary. Formulas: docs/queries.md.
struct PlaneHit {
  PlaneId id = kNoPlane;
  double range_m = 0.0;        ///< along the ray
  double sigma_m = 0.0;        ///< of the range, by the plane's covariance (first order)
  double incidence_rad = 0.0;  ///< between the ray and the normal's line: 0 square on, pi/2 edge-on
  bool from_behind = false;    ///< the ray comes from the side from which the plane was not seen
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< world frame
};

/// The first dense cell whose cube a ray enters.
struct CellHit {
  CellView cell;
  double entry_m = 0.0;                 ///< range at which the ray enters the cube; 0: it starts there
  double range_m = 0.0;                 ///< at which the ray passes nearest to the cell's virtual centre; not below 0
  double sigma_m = 0.0;                 ///< of that range, by the centre's standard errors
  std::optional<double> incidence_rad;  ///< to the cell's normal; empty: the cell has none
};

struct RayHits {
  std::optional<PlaneHit> plane;  ///< the nearest one; empty: none is met
  std::optional<CellHit> cell;
};

}  // namespace planemap

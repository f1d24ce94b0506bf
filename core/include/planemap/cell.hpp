#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <planemap/moments.hpp>

namespace planemap {

/// Cell statistics of Definition 1 with the full second moment. Points are taken relative to the cell's geometric
/// centre, which keeps the digits; the sums of two maps with the same grid still add.
struct CellSums {
  Moments points;                                      ///< weight = d(u) = n; first = L; second = S and its cross terms
  Eigen::Vector3d error_m2 = Eigen::Vector3d::Zero();  ///< S_s: sum of squared standard errors along the world's axes
  Eigen::Vector3f view = Eigen::Vector3f::Zero();      ///< sum over the points of unit vectors towards the sensor

  void add(const CellSums& other) {
    points.add(other.points);
    error_m2 += other.error_m2;
    view += other.view;
  }
  double count() const { return points.weight; }
  /// Mean variance of a point along a unit vector, square metres. @pre count() > 0
  double point_variance(const Eigen::Vector3d& direction) const {
    return direction.cwiseAbs2().dot(error_m2) / points.weight;
  }
};

/// Names a plane within one mapper; 0 is none.
using PlaneSlot = std::uint32_t;
constexpr PlaneSlot kNoSlot = 0;

/// What the map knows of one cube of space.
struct Cell {
  static constexpr std::uint32_t kNotWorking = 0xffffffff;

  CellSums sums;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< uncertain normal (Definition 3); zero: not known
  float deviation_rad = 0.0F;                        ///< its deviation by the min-max approach
  float normal_count = 0.0F;                         ///< points when the normal was last fitted
  float plane_weight = 0.0F;  ///< each of its points' weight in the plane's moments; 0: edge member
  PlaneSlot plane = kNoSlot;
  std::uint32_t working = kNotWorking;  ///< place in the working set while a scan is assigned

  bool has_normal() const { return normal.squaredNorm() > 0.5F; }
};

}  // namespace planemap

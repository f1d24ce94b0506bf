#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "query/plane_tree.hpp"

namespace planemap {

/// Goes from cube to cube along a ray, in a grid of cubes that ends somewhere (Amanatides and Woo, A Fast Voxel
/// Traversal Algorithm, 1987). Ranges are worked out anew from the faces' places, so that no error adds up.
class GridWalk {
 public:
  /// @param from_m  range at which the walk begins, >= 0; the ray is in one of the cubes there
  /// @param extent  least and greatest cube, both belong to it
  GridWalk(const RayLine& ray, double edge_m, double from_m, const Eigen::AlignedBox3i& extent)
      : ray_(ray), edge_m_(edge_m), entry_m_(from_m), extent_(extent) {
    const Eigen::Vector3d p_m = ray.at(from_m);
    for (int axis = 0; axis < 3; ++axis) {
      // Rounding may put the point beside the cubes that it is to be in.
      const double low = extent.min()[axis];
      const double high = extent.max()[axis];
      index_[axis] = static_cast<int>(std::clamp(std::floor(p_m[axis] / edge_m), low, high));
      update(axis);
    }
  }

  const Eigen::Vector3i& index() const { return index_; }
  double entry_m() const { return entry_m_; }           ///< range at which the ray comes into the cube
  double exit_m() const { return next_m_.minCoeff(); }  ///< at which it leaves it

  /// To the next cube; false: the grid ends here.
  bool step() {
    Eigen::Index axis = 0;
    const double exit_m = next_m_.minCoeff(&axis);
    if (!(exit_m < std::numeric_limits<double>::infinity())) return false;
    entry_m_ = std::max(entry_m_, exit_m);
    index_[axis] += ray_.direction[axis] > 0.0 ? 1 : -1;
    if (index_[axis] < extent_.min()[axis] || index_[axis] > extent_.max()[axis]) return false;
    update(static_cast<int>(axis));
    return true;
  }

 private:
  void update(int axis) {
    const double slope = ray_.direction[axis];
    const int face = index_[axis] + (slope > 0.0 ? 1 : 0);
    next_m_[axis] =
        slope == 0.0 ? std::numeric_limits<double>::infinity() : (face * edge_m_ - ray_.origin_m[axis]) / slope;
  }

  const RayLine& ray_;
  double edge_m_;
  double entry_m_;
  Eigen::AlignedBox3i extent_;
  Eigen::Vector3i index_ = Eigen::Vector3i::Zero();
  Eigen::Vector3d next_m_ = Eigen::Vector3d::Zero();  ///< range of the next face across each axis
};

}  // namespace planemap

#pragma once

#include <Eigen/Geometry>
#include <planemap/outline.hpp>
#include <vector>

namespace planemap {

/// Where a point of a plane is, seen from the plane's surface.
struct Spot {
  bool inside = false;                                  ///< within the boundary or on it
  double distance_m = 0.0;                              ///< to the surface; 0 inside
  Eigen::Vector2d nearest_m = Eigen::Vector2d::Zero();  ///< point of the surface, in the outline's basis
};

/// An outline made ready to be asked: which points are within it, and how far are the others?
class PreparedSurface {
 public:
  explicit PreparedSurface(const Outline& outline);

  const PlaneBasis& basis() const { return basis_; }
  bool empty() const { return edges_.empty(); }
  /// In the world; empty of an empty surface.
  const Eigen::AlignedBox3d& box() const { return box_; }

  /// @param uv_m  in the outline's basis
  /// @pre the surface is not empty
  Spot spot(const Eigen::Vector2d& uv_m) const;
  bool contains(const Eigen::Vector2d& uv_m) const;

 private:
  struct Edge {
    double u_m;
    double v_m;
    double du_m;
    double dv_m;
    double inverse_length2;  ///< 0 for a point
  };
  struct Border;
  void add(const Ring& ring);
  Border border(const Eigen::Vector2d& uv_m) const;

  PlaneBasis basis_;
  std::vector<Edge> edges_;
  Eigen::AlignedBox2d uv_box_;
  Eigen::AlignedBox3d box_;
};

}  // namespace planemap

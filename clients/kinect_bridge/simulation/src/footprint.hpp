#pragma once

#include <Eigen/Core>
#include <array>

namespace planemap::simulation {

/// Axis-aligned rectangle on the floor, metres in the apartment's frame.
struct Rectangle {
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();

  Eigen::Vector2d size_m() const { return max_m - min_m; }
  Eigen::Vector2d centre_m() const { return 0.5 * (min_m + max_m); }
  bool contains(const Eigen::Vector2d& p_m, double margin_m) const {
    return ((p_m - min_m).array() >= margin_m).all() && ((max_m - p_m).array() >= margin_m).all();
  }
};

/// Where a thing stands on the floor: a rectangle at any angle, metres in the apartment's frame.
struct Footprint {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d half_size_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< of its own x axis, unit

  static Footprint of(const Rectangle& r) { return {r.centre_m(), 0.5 * r.size_m(), Eigen::Vector2d::UnitX()}; }

  /// Unit; k = 0: along x of the footprint, 1: y.
  Eigen::Vector2d axis(int k) const { return k == 0 ? direction : Eigen::Vector2d(-direction.y(), direction.x()); }
  Eigen::Vector2d point_m(double along_x_m, double along_y_m) const;  ///< from the footprint's coordinates
  std::array<Eigen::Vector2d, 4> corners_m() const;                   ///< counter-clockwise
  Footprint grown(double margin_m) const;
  double distance_m(const Eigen::Vector2d& p_m) const;  ///< 0 inside
};

/// Whether two footprints have a point in common (separating axes).
bool overlap(const Footprint& a, const Footprint& b);

}  // namespace planemap::simulation

#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "footprint.hpp"

namespace planemap::simulation {

/// Where a robot can be among obstacles on the floor: a raster of the distance to the nearest one.
class FreeSpace {
 public:
  FreeSpace(const Rectangle& outline, const std::vector<Footprint>& obstacles);

  /// Distance from a point to the nearest obstacle, exact.
  double clearance_m(const Eigen::Vector2d& p_m) const;

  /// The nearest raster point to a wish with at least some clearance, inside a rectangle; empty if there is none.
  std::optional<Eigen::Vector2d> nearest_free(const Eigen::Vector2d& wish_m, const Rectangle& within,
                                              double clearance_m) const;
  /// The raster point with the most clearance inside a rectangle.
  Eigen::Vector2d roomiest(const Rectangle& within) const;

  /// A path between two free points, rather long than narrow; empty if there is none of the least clearance.
  std::vector<Eigen::Vector2d> path(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                                    double least_clearance_m) const;

 private:
  struct Node {
    int x = 0;
    int y = 0;
  };
  Node node_at(const Eigen::Vector2d& p_m) const;
  Eigen::Vector2d point_of(const Node& node) const;
  std::size_t index_of(const Node& node) const { return static_cast<std::size_t>(node.y) * columns_ + node.x; }
  Node node_of(std::size_t index) const {
    return {static_cast<int>(index % columns_), static_cast<int>(index / columns_)};
  }
  std::vector<Eigen::Vector2d> trace_back(const std::vector<std::size_t>& came_from, std::size_t from,
                                          std::size_t to) const;

  Rectangle outline_;
  std::vector<Footprint> obstacles_;
  int columns_;
  int rows_;
  std::vector<float> clearance_m_;  // by node
};

}  // namespace planemap::simulation

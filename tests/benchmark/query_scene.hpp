#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <planemap/snapshot.hpp>
#include <random>

namespace planemap::benchmark {

/// A made-up building: rooms of 4 m by 3 m by 2.6 m, each of floor, ceiling, four walls with a door in one of them, and
/// furniture, together 40 planes with their dense cells of 10 cm. Turned by 17 degrees against the grid.
class QueryScene {
 public:
  /// @param planes  at least 40; a multiple of 40 is made
  explicit QueryScene(std::size_t planes);

  const std::shared_ptr<const MapSnapshot>& snapshot() const { return snapshot_; }
  /// The same map after some planes were seen again: their records are others.
  std::shared_ptr<const MapSnapshot> seen_again(std::size_t planes) const;

  /// A place in some room, world frame.
  Eigen::Vector3d place(std::mt19937_64& random) const;

 private:
  std::size_t rooms_;
  std::size_t rooms_in_row_;
  Eigen::Isometry3d T_world_building_;
  std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace planemap::benchmark

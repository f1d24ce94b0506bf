#include "rooms.hpp"

#include <cmath>
#include <numbers>

namespace planemap::simulation {

Apartment empty_room(const Eigen::Vector3d& size_m, Random& random) {
  Apartment room;
  room.plan.outline.max_m = size_m.head<2>();
  room.plan.height_m = size_m.z();
  room.plan.wall_faces = {{0, +1, 0.0}, {0, -1, size_m.x()}, {1, +1, 0.0}, {1, -1, size_m.y()}};
  room.plan.rooms = {{room.plan.outline, {0, 1, 2, 3}}};
  room.T_world_apartment = random_placement(random);
  return room;
}

std::vector<Station> round_about(const Eigen::Vector2d& centre_m, double radius_m) {
  constexpr int kStations = 12;
  std::vector<Station> stations;
  for (int i = 0; i < kStations; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kStations;
    const Eigen::Vector2d p_m = centre_m + radius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    stations.push_back({{p_m.x(), p_m.y(), 1.2}, {centre_m.x(), centre_m.y(), i % 2 == 0 ? 0.7 : 1.8}});
  }
  return stations;
}

}  // namespace planemap::simulation

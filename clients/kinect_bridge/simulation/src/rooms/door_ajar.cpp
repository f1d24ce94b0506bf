#include <cmath>
#include <numbers>

#include "rooms.hpp"

namespace planemap::simulation {
namespace {

constexpr double kOpenedRad = 10.0 * std::numbers::pi / 180.0;
constexpr double kLeafThicknessM = 0.04;

/// Two rooms behind each other, with a door in the wall between them.
FloorPlan two_rooms() {
  FloorPlan plan;
  plan.outline.max_m = {4.0, 5.12};
  plan.height_m = 2.5;
  plan.wall_faces = {{0, +1, 0.0}, {0, -1, 4.0}, {1, +1, 0.0}, {1, -1, 1.5}, {1, +1, 1.62}, {1, -1, 5.12}};
  plan.rooms = {{{{0.0, 0.0}, {4.0, 1.5}}, {0, 1, 2, 3}}, {{{0.0, 1.62}, {4.0, 5.12}}, {0, 1, 4, 5}}};
  plan.doors = {{1, 1.5, 1.62, 1.5, 2.4, 2.0, 0, 1}};
  return plan;
}

/// Closed, its front would be in line with the wall; its hinge is at the wall's face.
Furniture leaf_of(const Door& door) {
  const Eigen::Vector2d hinge_m(door.from_m, door.high_m);
  const double length_m = door.to_m - door.from_m - 0.02;
  Furniture leaf{FurnitureKind::kDoorLeaf, {}, 0.01, door.height_m - 0.01};
  leaf.footprint.direction = {std::cos(kOpenedRad), std::sin(kOpenedRad)};
  leaf.footprint.half_size_m = {0.5 * length_m, 0.5 * kLeafThicknessM};
  leaf.footprint.centre_m =
      hinge_m + 0.5 * length_m * leaf.footprint.axis(0) - 0.5 * kLeafThicknessM * leaf.footprint.axis(1);
  return leaf;
}

}  // namespace

Scene make_door_ajar(Random& random) {
  Apartment rooms;
  rooms.plan = two_rooms();
  rooms.furniture = {leaf_of(rooms.plan.doors.front())};
  rooms.T_world_apartment = random_placement(random);
  const std::vector<Station> stations = {{{2.0, 4.4, 1.2}, {2.0, 2.7, 0.0}},  {{1.0, 3.6, 1.2}, {1.4, 1.62, 0.7}},
                                         {{1.2, 3.7, 1.2}, {1.6, 1.62, 1.6}}, {{2.0, 3.9, 1.2}, {2.0, 1.62, 0.9}},
                                         {{2.8, 3.6, 1.2}, {2.4, 1.62, 1.5}}, {{3.2, 3.0, 1.2}, {2.2, 1.62, 0.7}},
                                         {{3.3, 2.5, 1.2}, {2.2, 1.62, 1.2}}, {{2.6, 3.6, 1.2}, {2.0, 2.2, 0.0}}};
  return {rooms.T_world_apartment, make_surfaces(rooms), Tour::through(stations), 60};
}

}  // namespace planemap::simulation

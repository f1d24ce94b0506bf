#include <cmath>
#include <numbers>

#include "rooms.hpp"

namespace planemap::simulation {
namespace {

constexpr double kRadiusM = 0.2;
constexpr double kTurnedRad = 0.5;  // the pillar against the walls
constexpr double kHeightM = 2.5;
const Eigen::Vector2d kCentreM(2.4, 2.5);

}  // namespace

Scene make_pillar(Random& random) {
  const Apartment room = empty_room({4.8, 5.0, kHeightM}, random);
  SurfaceBuilder builder(room.T_world_apartment);
  add_surfaces(room, builder);
  const Footprint pillar{kCentreM, {kRadiusM, kRadiusM}, {std::cos(kTurnedRad), std::sin(kTurnedRad)}};
  builder.add_box("pillar", pillar, 0.0, kHeightM, {true, true, true, true, false}, PlaneClass::kOther);
  return {room.T_world_apartment, builder.take(), Tour::through(round_about(kCentreM, 1.8)), 96};
}

Scene make_column(Random& random) {
  const Apartment room = empty_room({4.8, 5.0, kHeightM}, random);
  SurfaceBuilder builder(room.T_world_apartment);
  add_surfaces(room, builder);
  builder.add_column("column", kCentreM, kRadiusM, 0.0, kHeightM);
  return {room.T_world_apartment, builder.take(), Tour::through(round_about(kCentreM, 1.8)), 96};
}

}  // namespace planemap::simulation

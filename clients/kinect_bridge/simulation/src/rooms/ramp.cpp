#include "rooms.hpp"

namespace planemap::simulation {

Scene make_ramp(Random& random) {
  constexpr double kWidthM = 2.0;
  constexpr double kBeginM = 3.0;
  constexpr double kTopM = 5.4;
  constexpr double kEndM = 7.6;
  constexpr double kRiseM = (kTopM - kBeginM) / 12.0;
  const Apartment room = empty_room({kWidthM, kEndM, 2.8}, random);  // its floor goes on under the ramp
  SurfaceBuilder builder(room.T_world_apartment);
  add_surfaces(room, builder);
  builder.add("ramp", PlaneClass::kOther, Eigen::Vector3d(0.0, -kRiseM, kTopM - kBeginM).normalized(),
              {{{0.0, kBeginM, 0.0}, {kWidthM, kBeginM, 0.0}, {kWidthM, kTopM, kRiseM}, {0.0, kTopM, kRiseM}}});
  builder.add("upper floor", PlaneClass::kFloor, Eigen::Vector3d::UnitZ(),
              {level_piece(Footprint::of({{0.0, kTopM}, {kWidthM, kEndM}}), kRiseM)});
  const std::vector<Station> stations = {{{1.0, 0.5, 1.2}, {1.0, 1.8, 0.0}},  {{0.8, 1.0, 1.2}, {1.0, 3.0, 0.0}},
                                         {{0.7, 2.2, 1.2}, {0.9, 4.3, 0.1}},  {{1.3, 3.4, 1.25}, {1.1, 5.6, 0.2}},
                                         {{1.0, 4.8, 1.35}, {1.0, 6.8, 0.2}}, {{1.2, 2.6, 1.2}, {1.0, 4.6, 0.1}}};
  return {room.T_world_apartment, builder.take(), Tour::through(stations), 80};
}

}  // namespace planemap::simulation

#include "rooms.hpp"

namespace planemap::simulation {

Scene make_thin_walls(Random& random) {
  const Apartment room = empty_room({6.0, 4.0, 2.5}, random);
  SurfaceBuilder builder(room.T_world_apartment);
  add_surfaces(room, builder);
  // The first one leaves a passage at high y, the second one at low y.
  builder.add_box("thin wall 1", Footprint::of({{1.95, 0.0}, {2.05, 2.6}}), 0.0, 2.5, {true, true, false, true, false},
                  PlaneClass::kOther);
  builder.add_box("thin wall 2", Footprint::of({{3.95, 1.4}, {4.05, 4.0}}), 0.0, 2.5, {true, true, true, false, false},
                  PlaneClass::kOther);
  const std::vector<Station> stations = {
      {{0.6, 1.2, 1.2}, {2.0, 1.0, 0.7}}, {{0.6, 1.6, 1.2}, {2.0, 1.5, 1.8}}, {{1.2, 3.3, 1.2}, {3.0, 3.3, 1.2}},
      {{2.9, 3.2, 1.2}, {4.0, 2.9, 0.9}}, {{2.7, 2.6, 1.2}, {4.0, 2.6, 1.7}}, {{3.3, 1.7, 1.2}, {2.0, 1.6, 0.8}},
      {{3.3, 1.2, 1.2}, {2.0, 1.0, 1.7}}, {{4.0, 0.7, 1.2}, {5.0, 0.7, 1.2}}, {{5.3, 1.8, 1.2}, {4.0, 2.2, 0.8}},
      {{5.4, 2.8, 1.2}, {4.0, 2.8, 1.7}}, {{4.0, 0.7, 1.2}, {3.0, 0.7, 1.2}}, {{3.0, 2.0, 1.2}, {2.0, 2.0, 1.2}},
      {{2.0, 3.3, 1.2}, {1.0, 3.3, 1.2}}};
  return {room.T_world_apartment, builder.take(), Tour::through(stations), 100};
}

}  // namespace planemap::simulation

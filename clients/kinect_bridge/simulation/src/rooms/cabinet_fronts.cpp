#include "rooms.hpp"

namespace planemap::simulation {

Scene make_cabinet_fronts(Random& random) {
  Apartment room = empty_room({4.0, 4.0, 2.5}, random);
  // Both are 6 cm deep; their fronts face into the room from wall 4 and from wall 2.
  room.furniture = {
      {FurnitureKind::kTallCabinet, {{1.8, 3.97}, {0.8, 0.03}, {-1.0, 0.0}}, 0.0, 2.0, true, true},
      {FurnitureKind::kLowCabinet, {{3.97, 1.4}, {0.6, 0.03}, {0.0, 1.0}}, 0.0, 1.0, true, true},
  };
  const std::vector<Station> stations = {{{0.9, 2.1, 1.2}, {1.0, 4.0, 1.7}}, {{0.9, 2.0, 1.2}, {1.0, 4.0, 0.7}},
                                         {{1.8, 1.9, 1.2}, {1.8, 4.0, 0.6}}, {{1.8, 1.9, 1.2}, {1.8, 4.0, 1.9}},
                                         {{2.6, 2.1, 1.2}, {2.7, 4.0, 1.7}}, {{2.6, 2.0, 1.2}, {2.7, 4.0, 0.7}},
                                         {{2.1, 1.6, 1.2}, {4.0, 2.0, 0.7}}, {{2.1, 1.5, 1.2}, {4.0, 1.5, 1.8}},
                                         {{2.1, 1.2, 1.2}, {4.0, 1.0, 0.6}}, {{2.1, 1.2, 1.2}, {4.0, 1.2, 1.4}}};
  return {room.T_world_apartment, make_surfaces(room), Tour::through(stations), 80};
}

}  // namespace planemap::simulation

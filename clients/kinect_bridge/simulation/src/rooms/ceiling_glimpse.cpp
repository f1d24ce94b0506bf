#include "rooms.hpp"

namespace planemap::simulation {

Scene make_ceiling_glimpse(Random& random) {
  Apartment room = empty_room({5.0, 4.0, 2.6}, random);
  // Always so low that the image ends below the ceiling, but for one look up.
  const std::vector<Station> stations = {{{0.8, 1.0, 1.2}, {4.0, 1.6, 0.0}}, {{1.0, 2.0, 1.2}, {4.4, 2.2, 0.0}},
                                         {{1.0, 2.0, 1.2}, {3.0, 2.1, 2.7}}, {{1.0, 2.0, 1.2}, {4.4, 2.2, 0.0}},
                                         {{1.0, 3.2, 1.2}, {4.0, 2.4, 0.0}}, {{2.2, 3.0, 1.2}, {4.4, 1.4, 0.2}},
                                         {{2.2, 1.2, 1.2}, {4.4, 2.6, 0.2}}};
  return {room.T_world_apartment, make_surfaces(room), Tour::through(stations), 28};
}

}  // namespace planemap::simulation

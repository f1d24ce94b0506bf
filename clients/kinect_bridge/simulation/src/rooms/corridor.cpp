#include "rooms.hpp"

namespace planemap::simulation {

Scene make_corridor(Random& random) {
  Apartment room = empty_room({1.6, 9.0, 2.5}, random);
  // Forwards and back again, looking along the corridor all the while: the walls are seen at 60 degrees and more.
  const std::vector<Station> stations = {{{0.7, 0.5, 1.2}, {0.8, 9.0, 1.1}}, {{0.9, 6.5, 1.2}, {0.8, 9.0, 1.2}}};
  return {room.T_world_apartment, make_surfaces(room), Tour::through(stations), 60};
}

}  // namespace planemap::simulation

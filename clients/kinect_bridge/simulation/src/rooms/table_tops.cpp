#include "rooms.hpp"

namespace planemap::simulation {

Scene make_table_tops(Random& random) {
  Apartment room = empty_room({5.2, 4.5, 2.5}, random);
  constexpr double kTopM = 0.74;
  room.furniture = {{FurnitureKind::kTable, {{1.6, 2.4}, {0.7, 0.4}}, 0.0, kTopM},
                    {FurnitureKind::kTable, {{3.6, 2.4}, {0.7, 0.4}}, 0.0, kTopM}};
  SurfaceBuilder builder(room.T_world_apartment);
  add_surfaces(room, builder);
  for (std::size_t i = 0; i < room.furniture.size(); ++i) {
    builder.add("table " + std::to_string(i + 1) + " underside", PlaneClass::kOther, -Eigen::Vector3d::UnitZ(),
                {level_piece(room.furniture[i].footprint, kTopM - kTableTopM)});
  }
  // First from above, then from below.
  const std::vector<Station> stations = {{{1.0, 1.1, 1.5}, {1.3, 2.4, 0.7}},  {{2.6, 0.9, 1.5}, {2.6, 2.4, 0.7}},
                                         {{4.2, 1.1, 1.5}, {3.9, 2.4, 0.7}},  {{4.2, 1.4, 0.25}, {3.9, 2.4, 0.7}},
                                         {{3.2, 1.4, 0.25}, {3.3, 2.4, 0.7}}, {{2.0, 1.4, 0.25}, {1.9, 2.4, 0.7}},
                                         {{1.0, 1.4, 0.25}, {1.3, 2.4, 0.7}}};
  return {room.T_world_apartment, builder.take(), Tour::through(stations), 80};
}

}  // namespace planemap::simulation

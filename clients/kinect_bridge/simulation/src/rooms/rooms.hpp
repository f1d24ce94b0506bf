#pragma once

#include <Eigen/Core>
#include <vector>

#include "../apartment.hpp"
#include "../scene.hpp"

namespace planemap::simulation {

// Special rooms: the seed places them in the world; their shapes are always the same. What each shows is in scenes.cpp.

Scene make_door_ajar(Random& random);
Scene make_thin_walls(Random& random);
Scene make_cabinet_fronts(Random& random);
Scene make_table_tops(Random& random);
Scene make_stairs(Random& random);
Scene make_ramp(Random& random);
Scene make_pillar(Random& random);
Scene make_column(Random& random);
Scene make_corridor(Random& random);
Scene make_ceiling_glimpse(Random& random);

/// One room without doors, a corner at the origin, at a random place in the world. Its surfaces are "floor", "ceiling",
/// "wall 1" at x = 0, "wall 2" opposite, "wall 3" at y = 0, "wall 4" opposite.
Apartment empty_room(const Eigen::Vector3d& size_m, Random& random);

/// Stations on a circle about an upright thing, which is looked at low and high in turn.
std::vector<Station> round_about(const Eigen::Vector2d& centre_m, double radius_m);

}  // namespace planemap::simulation

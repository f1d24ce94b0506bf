#pragma once

#include <cstddef>
#include <cstdint>
#include <planemap/simulation/surface.hpp>
#include <vector>

#include "../apartment.hpp"

namespace planemap::simulation {

/// A wing of the endless building: a corridor of some 48 m with rooms on either side. Wing w lies between y = 14 w and
/// 14 (w + 1) metres of the building's frame; at alternate ends of the corridors a passage leads on to the next wing.
struct Wing {
  Apartment apartment;       ///< rooms first, then corridor and passages; its place in the world is the building's
  std::size_t corridor = 0;  ///< number of the room that is the corridor
  std::vector<std::size_t> stops;  ///< doors of the rooms, in the order in which one comes by them
  bool upwards = true;             ///< one goes through the corridor towards greater x
  Eigen::Vector2d entrance_m;      ///< on the corridor's middle line, where one comes from the wing before
  Eigen::Vector2d exit_m;          ///< the same, where one leaves for the next; both along the passage's middle line
};

constexpr double kWingPitchM = 14.0;  ///< from wing to wing

/// The wing of that number, the same one whenever it is made. Ceilings of all wings are level.
Wing make_wing(std::uint64_t seed, std::size_t number);

}  // namespace planemap::simulation

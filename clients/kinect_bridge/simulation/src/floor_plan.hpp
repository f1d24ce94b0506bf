#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "footprint.hpp"
#include "random.hpp"

namespace planemap::simulation {

// The apartment's frame: x and y along its walls, z up, floor at z = 0. All lengths are metres.

/// One side of a wall: an upright plane along the whole of the wall, which several rooms may share.
struct WallFace {
  int axis = 0;  ///< its normal's: 0 x, 1 y
  int sign = 1;  ///< the normal points towards +axis or -axis, into the rooms
  double position_m = 0.0;
};

struct Room {
  Rectangle floor;
  std::array<std::size_t, 4> faces{};  ///< wall faces at low x, high x, low y, high y; kOpenSide: there is none
  bool furnished = true;               ///< else nothing stands in it
};
constexpr std::size_t kOpenSide = std::numeric_limits<std::size_t>::max();

/// An opening through the wall between two rooms.
struct Door {
  int axis = 0;        ///< normal of the wall: 0 x, 1 y
  double low_m = 0.0;  ///< the wall's two faces, along the axis
  double high_m = 0.0;
  double from_m = 0.0;  ///< the opening, along the wall
  double to_m = 0.0;
  double height_m = 0.0;
  std::size_t low_room = 0;   ///< on the side of low_m
  std::size_t high_room = 0;  ///< on the side of high_m

  /// The opening's ground plan: the threshold.
  Rectangle threshold() const;
};

/// The rooms and how one gets from one to another.
struct FloorPlan {
  Rectangle outline;      ///< inside of the outer walls
  double height_m = 0.0;  ///< of the ceiling
  std::vector<Room> rooms;
  std::vector<WallFace> wall_faces;
  std::vector<Door> doors;       ///< connect all rooms
  std::vector<Footprint> walls;  ///< ground plans of the walls without the doors' openings
};

/// Divides a random outline into four or five rooms by thin walls and connects them by doors.
FloorPlan make_floor_plan(Random& random);

}  // namespace planemap::simulation

#pragma once

#include <vector>

#include "floor_plan.hpp"

namespace planemap::simulation {

enum class FurnitureKind { kTallCabinet, kLowCabinet, kTable, kSlantedBoard, kDoorLeaf };

/// A thing in a room. What leans on a wall has its back at low y of its footprint, its front at high y.
struct Furniture {
  FurnitureKind kind = FurnitureKind::kTable;
  Footprint footprint;
  double bottom_m = 0.0;  ///< above the floor
  double top_m = 0.0;
  bool low_side_free = true;   ///< its side at low x can be seen, does not stand in a corner
  bool high_side_free = true;  ///< its side at high x
};

/// Furnishes the rooms so that every door stays passable and everything but the backs can be seen from somewhere. There
/// is at least one of each kind; empty if the rooms are too small for that.
std::vector<Furniture> make_furniture(const FloorPlan& plan, Random& random);

}  // namespace planemap::simulation

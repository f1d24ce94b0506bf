#include "furniture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace planemap::simulation {
namespace {

constexpr double kSideViewM = 1.25;  // free beside a cabinet, so that its side is seen at less than a grazing angle
constexpr double kPassageM = 0.8;    // free around a table: the robot goes round it
constexpr double kDoorClearM = 1.0;  // free in front of a door
constexpr double kDoorSideM = 0.2;   // free beside it
constexpr double kLeafThicknessM = 0.04;
constexpr int kTriesPerPiece = 60;

/// Width along the wall, depth from it, height.
struct Size {
  double width_m;
  double depth_m;
  double height_m;
};

class Furnisher {
 public:
  Furnisher(const FloorPlan& plan, Random& random) : plan_(plan), random_(random) {}

  std::vector<Furniture> furnish() {
    hang_door_leaves();
    std::vector<std::size_t> order(plan_.rooms.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
      return plan_.rooms[a].floor.size_m().prod() > plan_.rooms[b].floor.size_m().prod();
    });
    bool board_stands = false;
    for (const std::size_t room : order) {
      if (!plan_.rooms[room].furnished) continue;
      if (!board_stands) board_stands = lean(room, FurnitureKind::kSlantedBoard);
      set_table(room);
      const bool tall_first = random_.chance(0.5);
      lean(room, tall_first ? FurnitureKind::kTallCabinet : FurnitureKind::kLowCabinet);
      lean(room, tall_first ? FurnitureKind::kLowCabinet : FurnitureKind::kTallCabinet);
    }
    return has_every_kind() ? std::move(placed_) : std::vector<Furniture>{};
  }

 private:
  bool has_every_kind() const {
    constexpr std::array kKinds = {FurnitureKind::kTallCabinet, FurnitureKind::kLowCabinet, FurnitureKind::kTable,
                                   FurnitureKind::kSlantedBoard, FurnitureKind::kDoorLeaf};
    return std::all_of(kKinds.begin(), kKinds.end(), [this](FurnitureKind kind) {
      return std::any_of(placed_.begin(), placed_.end(), [kind](const Furniture& f) { return f.kind == kind; });
    });
  }

  Size size_of(FurnitureKind kind) {
    switch (kind) {
      case FurnitureKind::kTallCabinet:
        return {random_.uniform(0.8, 1.6), random_.uniform(0.40, 0.60), random_.uniform(1.9, 2.2)};
      case FurnitureKind::kLowCabinet:
        return {random_.uniform(1.0, 1.7), random_.uniform(0.40, 0.55), random_.uniform(0.45, 0.65)};
      case FurnitureKind::kSlantedBoard:
        return {random_.uniform(1.0, 1.4), random_.uniform(0.85, 1.1), random_.uniform(1.2, 1.5)};
      case FurnitureKind::kTable:
        return {random_.uniform(1.2, 1.6), random_.uniform(0.75, 0.90), random_.uniform(0.70, 0.78)};
      case FurnitureKind::kDoorLeaf:
        break;
    }
    return {0.0, 0.0, 0.0};
  }

  /// Whether a thing keeps clear of the doors, and by a gap of everything else.
  bool fits(const Footprint& footprint, double gap_m) const {
    for (const Door& door : plan_.doors) {
      Rectangle zone = door.threshold();
      zone.min_m[door.axis] -= kDoorClearM;
      zone.max_m[door.axis] += kDoorClearM;
      zone.min_m[1 - door.axis] -= kDoorSideM;
      zone.max_m[1 - door.axis] += kDoorSideM;
      if (overlap(footprint, Footprint::of(zone))) return false;
    }
    const Footprint wanted = footprint.grown(gap_m);
    return std::none_of(placed_.begin(), placed_.end(),
                        [&wanted](const Furniture& other) { return overlap(wanted, other.footprint); });
  }

  /// Puts a thing with its back to a wall: somewhere along it, or a cabinet also into a corner.
  bool lean(std::size_t room, FurnitureKind kind) {
    for (int attempt = 0; attempt < kTriesPerPiece; ++attempt) {
      const Furniture item = leaning_candidate(plan_.rooms[room].floor, kind);
      if (!item.low_side_free && !item.high_side_free) continue;
      if (!fits(item.footprint, kSideViewM)) continue;
      placed_.push_back(item);
      return true;
    }
    return false;
  }

  /// Both sides marked as not free: the thing is too long for the wall.
  Furniture leaning_candidate(const Rectangle& room, FurnitureKind kind) {
    const Size size = size_of(kind);
    const int axis = random_.integer(0, 1);  // of the wall's normal
    const bool high_wall = random_.chance(0.5);
    const double inwards = high_wall ? -1.0 : 1.0;
    const double wall_m = high_wall ? room.max_m[axis] : room.min_m[axis];
    const double begin_m = room.min_m[1 - axis];
    const double end_m = room.max_m[1 - axis];

    Furniture item{kind, {}, 0.0, size.height_m};
    double along_m = 0.0;  // centre of the thing
    const int place = kind == FurnitureKind::kSlantedBoard ? 2 : random_.integer(0, 2);
    bool at_begin = false;
    bool at_end = false;
    if (place == 2) {
      const double first_m = begin_m + kSideViewM + 0.5 * size.width_m;
      const double last_m = end_m - kSideViewM - 0.5 * size.width_m;
      along_m = random_.uniform(first_m, std::max(first_m, last_m));
      if (last_m < first_m) at_begin = at_end = true;
    } else {
      at_begin = place == 0;
      at_end = place == 1;
      along_m = at_begin ? begin_m + 0.5 * size.width_m : end_m - 0.5 * size.width_m;
      if (size.width_m + kSideViewM > end_m - begin_m) at_begin = at_end = true;
    }
    item.footprint.half_size_m = {0.5 * size.width_m, 0.5 * size.depth_m};
    item.footprint.centre_m[axis] = wall_m + inwards * 0.5 * size.depth_m;
    item.footprint.centre_m[1 - axis] = along_m;
    // Turned so that the footprint's y axis points into the room; its x axis then runs along the wall or against it.
    item.footprint.direction = axis == 0 ? Eigen::Vector2d(0.0, -inwards) : Eigen::Vector2d(inwards, 0.0);
    const bool x_runs_up = item.footprint.axis(0)[1 - axis] > 0.0;
    item.low_side_free = !(x_runs_up ? at_begin : at_end);
    item.high_side_free = !(x_runs_up ? at_end : at_begin);
    return item;
  }

  /// A table that one can walk around, at a small angle to the walls.
  void set_table(std::size_t room) {
    const Rectangle& floor = plan_.rooms[room].floor;
    for (int attempt = 0; attempt < kTriesPerPiece; ++attempt) {
      const Size size = size_of(FurnitureKind::kTable);
      Furniture table{FurnitureKind::kTable, {}, 0.0, size.height_m};
      table.footprint.half_size_m = {0.5 * size.width_m, 0.5 * size.depth_m};
      table.footprint.centre_m = {random_.uniform(floor.min_m.x(), floor.max_m.x()),
                                  random_.uniform(floor.min_m.y(), floor.max_m.y())};
      const double angle_rad = random_.uniform(-0.35, 0.35) + (random_.chance(0.5) ? 0.5 * std::numbers::pi : 0.0);
      table.footprint.direction = {std::cos(angle_rad), std::sin(angle_rad)};
      const auto corners = table.footprint.corners_m();
      const bool inside = std::all_of(corners.begin(), corners.end(),
                                      [&floor](const Eigen::Vector2d& p) { return floor.contains(p, kPassageM); });
      if (!inside || !fits(table.footprint, kPassageM)) continue;
      placed_.push_back(table);
      return;
    }
  }

  /// A door's leaf, opened a bit beyond a right angle, hinged at one end of the opening on one side of the wall. Empty
  /// if it would come too near to a wall for both of its sides to be seen.
  std::optional<Furniture> leaf_candidate(const Door& door) {
    const bool in_high_room = random_.chance(0.5);
    const bool hinge_at_end = random_.chance(0.5);
    const Room& opened_into = plan_.rooms[in_high_room ? door.high_room : door.low_room];
    if (!opened_into.furnished) return std::nullopt;
    const Rectangle& room = opened_into.floor;
    const double behind_m =
        hinge_at_end ? room.max_m[1 - door.axis] - door.to_m : door.from_m - room.min_m[1 - door.axis];
    if (behind_m < kSideViewM) return std::nullopt;

    Eigen::Vector2d into_room = Eigen::Vector2d::Zero();
    into_room[door.axis] = in_high_room ? 1.0 : -1.0;
    Eigen::Vector2d across = Eigen::Vector2d::Zero();  // from the hinge over the opening
    across[1 - door.axis] = hinge_at_end ? -1.0 : 1.0;
    const double opened_rad = random_.uniform(1.57, 1.85);
    const double length_m = door.to_m - door.from_m - 0.02;
    const Eigen::Vector2d along = std::cos(opened_rad) * across + std::sin(opened_rad) * into_room;
    const Eigen::Vector2d outwards = -std::sin(opened_rad) * across + std::cos(opened_rad) * into_room;
    Eigen::Vector2d hinge_m;
    hinge_m[door.axis] = in_high_room ? door.high_m : door.low_m;
    hinge_m[1 - door.axis] = hinge_at_end ? door.to_m : door.from_m;

    Furniture leaf{FurnitureKind::kDoorLeaf, {}, 0.01, door.height_m - 0.01};
    leaf.footprint.half_size_m = {0.5 * length_m, 0.5 * kLeafThicknessM};
    leaf.footprint.centre_m = hinge_m + 0.03 * into_room + 0.5 * length_m * along + 0.5 * kLeafThicknessM * outwards;
    leaf.footprint.direction = along;
    return leaf;
  }

  /// One or two doors have a leaf that stands open.
  void hang_door_leaves() {
    const int wanted = random_.integer(1, 2);
    int hung = 0;
    for (const Door& door : plan_.doors) {
      if (hung == wanted) break;
      for (int attempt = 0; attempt < 8; ++attempt) {
        const auto leaf = leaf_candidate(door);
        if (!leaf || !clear_of_other_doors(leaf->footprint, door)) continue;
        placed_.push_back(*leaf);
        ++hung;
        break;
      }
    }
  }

  bool clear_of_other_doors(const Footprint& leaf, const Door& own) const {
    const Footprint wanted = leaf.grown(kPassageM);
    const bool doors_clear = std::all_of(plan_.doors.begin(), plan_.doors.end(), [&](const Door& door) {
      return &door == &own || !overlap(wanted, Footprint::of(door.threshold()));
    });
    return doors_clear && std::none_of(placed_.begin(), placed_.end(),
                                       [&wanted](const Furniture& other) { return overlap(wanted, other.footprint); });
  }

  const FloorPlan& plan_;
  Random& random_;
  std::vector<Furniture> placed_;
};

}  // namespace

std::vector<Furniture> make_furniture(const FloorPlan& plan, Random& random) {
  return Furnisher(plan, random).furnish();
}

}  // namespace planemap::simulation

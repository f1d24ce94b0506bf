#include "floor_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

namespace planemap::simulation {
namespace {

constexpr double kMinRoomSideM = 2.3;
constexpr double kMinDoorMarginM = 0.25;  // from a door to the next corner
constexpr double kMinWallOffsetM = 0.3;   // parallel walls are in line exactly or by far
constexpr double kOuterWallM = 0.3;
constexpr int kMaxTries = 1000;

/// An inner wall: a slab with a face on either side.
struct InnerWall {
  int axis = 0;
  double low_m = 0.0;
  double high_m = 0.0;
  double from_m = 0.0;
  double to_m = 0.0;
  std::size_t low_face = 0;   // seen from the rooms below low_m
  std::size_t high_face = 0;  // seen from the rooms above high_m
};

Rectangle slab(int axis, double low_m, double high_m, double from_m, double to_m) {
  return axis == 0 ? Rectangle{{low_m, from_m}, {high_m, to_m}} : Rectangle{{from_m, low_m}, {to_m, high_m}};
}

/// Divides the outline by walls, the largest room first, and remembers the walls.
class Divider {
 public:
  Divider(FloorPlan& plan, Random& random) : plan_(plan), random_(random) {
    Room whole{plan.outline, {}};
    for (int axis = 0; axis < 2; ++axis) {
      whole.faces[2 * axis] = add_face(axis, +1, plan.outline.min_m[axis]);
      whole.faces[2 * axis + 1] = add_face(axis, -1, plan.outline.max_m[axis]);
    }
    plan_.rooms = {whole};
  }

  bool divide_into(std::size_t rooms) {
    while (plan_.rooms.size() < rooms) {
      const auto largest = std::max_element(plan_.rooms.begin(), plan_.rooms.end(), [](const Room& a, const Room& b) {
        return a.floor.size_m().prod() < b.floor.size_m().prod();
      });
      if (!split(*largest)) return false;
    }
    return true;
  }

  const std::vector<InnerWall>& walls() const { return walls_; }

 private:
  std::size_t add_face(int axis, int sign, double position_m) {
    plan_.wall_faces.push_back({axis, sign, position_m});
    return plan_.wall_faces.size() - 1;
  }

  bool near_another_wall(int axis, double centre_m) const {
    return std::any_of(walls_.begin(), walls_.end(), [&](const InnerWall& wall) {
      return wall.axis == axis && std::abs(0.5 * (wall.low_m + wall.high_m) - centre_m) < kMinWallOffsetM;
    });
  }

  bool split(Room& room) {
    const Eigen::Vector2d size_m = room.floor.size_m();
    const int axis = size_m.x() > size_m.y() ? 0 : 1;
    const double thickness_m = random_.uniform(0.10, 0.12);
    const double low_m = room.floor.min_m[axis] + kMinRoomSideM + 0.5 * thickness_m;
    const double high_m = room.floor.max_m[axis] - kMinRoomSideM - 0.5 * thickness_m;
    if (low_m >= high_m) return false;
    const double centre_m = room.floor.min_m[axis] + size_m[axis] * random_.uniform(0.42, 0.58);
    if (centre_m < low_m || centre_m > high_m || near_another_wall(axis, centre_m)) return false;

    InnerWall wall{axis, centre_m - 0.5 * thickness_m, centre_m + 0.5 * thickness_m, room.floor.min_m[1 - axis],
                   room.floor.max_m[1 - axis]};
    wall.low_face = add_face(axis, -1, wall.low_m);
    wall.high_face = add_face(axis, +1, wall.high_m);
    Room upper = room;
    upper.floor.min_m[axis] = wall.high_m;
    upper.faces[2 * axis] = wall.high_face;
    room.floor.max_m[axis] = wall.low_m;
    room.faces[2 * axis + 1] = wall.low_face;
    plan_.rooms.push_back(upper);  // `room` may dangle from here on
    walls_.push_back(wall);
    return true;
  }

  FloorPlan& plan_;
  Random& random_;
  std::vector<InnerWall> walls_;
};

/// A door between two rooms, where they have enough of a wall in common.
std::optional<Door> door_between(const FloorPlan& plan, const InnerWall& wall, std::size_t low_room,
                                 std::size_t high_room, Random& random) {
  const Room& low = plan.rooms[low_room];
  const Room& high = plan.rooms[high_room];
  const int axis = wall.axis;
  if (low.faces[2 * axis + 1] != wall.low_face || high.faces[2 * axis] != wall.high_face) return std::nullopt;
  const double width_m = random.uniform(0.85, 0.95);
  const double from_m = std::max(low.floor.min_m[1 - axis], high.floor.min_m[1 - axis]) + kMinDoorMarginM;
  const double to_m = std::min(low.floor.max_m[1 - axis], high.floor.max_m[1 - axis]) - kMinDoorMarginM - width_m;
  if (from_m >= to_m) return std::nullopt;
  const double begin_m = random.uniform(from_m, to_m);
  return Door{axis,     wall.low_m, wall.high_m, begin_m, begin_m + width_m, random.uniform(1.98, 2.04),
              low_room, high_room};
}

/// All rooms connected by as few doors as possible, and now and then one more. False: some room can't be reached.
bool connect(FloorPlan& plan, const std::vector<InnerWall>& walls, Random& random) {
  std::vector<Door> candidates;
  for (const InnerWall& wall : walls) {
    for (std::size_t low = 0; low < plan.rooms.size(); ++low) {
      for (std::size_t high = 0; high < plan.rooms.size(); ++high) {
        if (const auto door = door_between(plan, wall, low, high, random)) candidates.push_back(*door);
      }
    }
  }
  for (std::size_t i = candidates.size(); i > 1; --i) {
    std::swap(candidates[i - 1], candidates[static_cast<std::size_t>(random.integer(0, static_cast<int>(i) - 1))]);
  }
  std::vector<std::size_t> group(plan.rooms.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (const Door& door : candidates) {
    const std::size_t kept = group[door.low_room];
    const std::size_t joined = group[door.high_room];
    if (kept == joined && !random.chance(0.25)) continue;
    plan.doors.push_back(door);
    std::replace(group.begin(), group.end(), joined, kept);
  }
  return std::all_of(group.begin(), group.end(), [&group](std::size_t g) { return g == group.front(); });
}

/// The solid parts of the walls on the ground plan.
std::vector<Footprint> solid_walls(const FloorPlan& plan, const std::vector<InnerWall>& inner) {
  std::vector<Footprint> solid;
  for (const InnerWall& wall : inner) {
    std::vector<std::pair<double, double>> openings;
    for (const Door& door : plan.doors) {
      if (door.axis == wall.axis && door.low_m == wall.low_m && door.from_m >= wall.from_m && door.to_m <= wall.to_m) {
        openings.emplace_back(door.from_m, door.to_m);
      }
    }
    std::sort(openings.begin(), openings.end());
    openings.emplace_back(wall.to_m, wall.to_m);
    double from_m = wall.from_m;
    for (const auto& opening : openings) {
      solid.push_back(Footprint::of(slab(wall.axis, wall.low_m, wall.high_m, from_m, opening.first)));
      from_m = opening.second;
    }
  }
  const Eigen::Vector2d& low = plan.outline.min_m;
  const Eigen::Vector2d& high = plan.outline.max_m;
  for (int axis = 0; axis < 2; ++axis) {
    const double from_m = low[1 - axis] - kOuterWallM;
    const double to_m = high[1 - axis] + kOuterWallM;
    solid.push_back(Footprint::of(slab(axis, low[axis] - kOuterWallM, low[axis], from_m, to_m)));
    solid.push_back(Footprint::of(slab(axis, high[axis], high[axis] + kOuterWallM, from_m, to_m)));
  }
  return solid;
}

}  // namespace

Rectangle Door::threshold() const {
  return slab(axis, low_m, high_m, from_m, to_m);
}

FloorPlan make_floor_plan(Random& random) {
  for (int attempt = 0; attempt < kMaxTries; ++attempt) {
    FloorPlan plan;
    plan.outline.max_m = {random.uniform(8.4, 10.4), random.uniform(7.2, 8.4)};
    plan.height_m = random.uniform(2.5, 2.7);
    Divider divider(plan, random);
    if (!divider.divide_into(static_cast<std::size_t>(random.integer(4, 5)))) continue;
    if (!connect(plan, divider.walls(), random)) continue;
    plan.walls = solid_walls(plan, divider.walls());
    return plan;
  }
  throw std::runtime_error("make_floor_plan: no floor plan in 1000 tries");
}

}  // namespace planemap::simulation

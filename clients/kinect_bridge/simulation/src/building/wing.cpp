#include "wing.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "../random.hpp"

namespace planemap::simulation {
namespace {

constexpr double kLengthM = 48.0;    // of a corridor, give or take the ends
constexpr double kEndM = 1.5;        // by which the ends of wings, sides and passages differ
constexpr double kOuterWallM = 0.3;  // between wings; half of it belongs to either
constexpr double kMinRoomM = 2.8;    // along the corridor
constexpr double kMaxRoomM = 6.0;
constexpr double kDoorMarginM = 0.3;  // from a door to the next corner
constexpr double kPortalMarginM = 0.1;
constexpr double kPortalHeightM = 2.2;
constexpr int kMaxTries = 100;

/// Streams of the seed: one for what a wing is made of, one for what it has in common with the one before.
std::uint64_t wing_stream(std::size_t number) {
  return 1000 + 2 * number;
}
std::uint64_t boundary_stream(std::size_t number) {
  return 1001 + 2 * number;
}

struct Span {
  double from_m = 0.0;
  double to_m = 0.0;
  double middle_m() const { return 0.5 * (from_m + to_m); }
};

/// Along x: the passage from wing number - 1, at the high end where the number is odd. @pre number > 0
Span passage_into(std::uint64_t seed, std::size_t number) {
  Random random(seed, boundary_stream(number));
  const double width_m = random.uniform(1.8, 2.6);
  const double end_m = random.uniform(-kEndM, kEndM);
  if (number % 2 == 1) return {kLengthM + end_m - width_m, kLengthM + end_m};
  return {end_m, end_m + width_m};
}

/// Puts a wing's rooms together, one side of the corridor after the other.
class WingPlanner {
 public:
  WingPlanner(std::uint64_t seed, std::size_t number)
      : seed_(seed), number_(number), random_(seed, wing_stream(number)) {}

  Wing plan() {
    wing_.upwards = number_ % 2 == 0;
    plan_.height_m = Random(seed_, boundary_stream(0)).uniform(2.5, 2.9);
    const double low_m = kWingPitchM * static_cast<double>(number_);
    const double width_m = random_.uniform(1.8, 2.6);
    const double south_wall_m = random_.uniform(0.10, 0.14);
    const double north_wall_m = random_.uniform(0.10, 0.14);
    corridor_.from_m = low_m + 0.5 * kOuterWallM + random_.uniform(4.2, 6.2) + south_wall_m;
    corridor_.to_m = corridor_.from_m + width_m;
    add_side(/*north=*/false, {low_m + 0.5 * kOuterWallM, corridor_.from_m - south_wall_m});
    add_side(/*north=*/true, {corridor_.to_m + north_wall_m, low_m + kWingPitchM - 0.5 * kOuterWallM});
    add_corridor();
    for (const Passage& passage : passages_) add_passage(passage);
    plan_.outline = {{ends_.from_m, low_m}, {ends_.to_m, low_m + kWingPitchM}};
    add_stops();
    wing_.apartment.plan = plan_;
    return std::move(wing_);
  }

 private:
  /// From the corridor to the wing before or behind.
  struct Passage {
    bool north = false;
    Span along_x;
    Span along_y;              // from the corridor's wall to the next wing
    std::size_t low_face = 0;  // at low x
    std::size_t high_face = 0;
    std::size_t corridor_face = 0;  // of the corridor's wall, within the passage
  };

  std::size_t add_face(int axis, int sign, double position_m) {
    plan_.wall_faces.push_back({axis, sign, position_m});
    return plan_.wall_faces.size() - 1;
  }

  void add_side(bool north, const Span& depth) {
    const bool has_passage = north || number_ > 0;
    Span rooms{random_.uniform(-kEndM, kEndM), kLengthM + random_.uniform(-kEndM, kEndM)};
    const std::size_t inner = add_face(1, north ? +1 : -1, north ? depth.from_m : depth.to_m);
    const std::size_t outer = add_face(1, north ? -1 : +1, north ? depth.to_m : depth.from_m);
    Passage passage{north, {}, depth, 0, 0, inner};
    const bool high = north == wing_.upwards;  // at which end the passage is
    if (has_passage) {
      passage.along_x = passage_into(seed_, north ? number_ + 1 : number_);
      const double border_m = kWingPitchM * static_cast<double>(north ? number_ + 1 : number_);
      (north ? passage.along_y.to_m : passage.along_y.from_m) = border_m;
      const double wall_m = random_.uniform(0.10, 0.14);
      passage.low_face = add_face(0, +1, passage.along_x.from_m);
      passage.high_face = add_face(0, -1, passage.along_x.to_m);
      if (high)
        rooms.to_m = passage.along_x.from_m - wall_m;
      else
        rooms.from_m = passage.along_x.to_m + wall_m;
      passages_.push_back(passage);
      ends_ = {std::min(ends_.from_m, passage.along_x.from_m), std::max(ends_.to_m, passage.along_x.to_m)};
    }
    ends_ = {std::min(ends_.from_m, rooms.from_m), std::max(ends_.to_m, rooms.to_m)};
    divide(rooms, depth, north, inner, outer);
  }

  /// Rooms side by side, each with a door to the corridor.
  void divide(const Span& rooms, const Span& depth, bool north, std::size_t inner, std::size_t outer) {
    double at_m = rooms.from_m;
    std::size_t low_face = add_face(0, +1, at_m);
    while (at_m < rooms.to_m) {
      const double wall_m = random_.uniform(0.10, 0.14);
      const double most_m = rooms.to_m - at_m - wall_m - kMinRoomM;
      const bool is_last = most_m < kMinRoomM;
      const double end_m = is_last ? rooms.to_m : at_m + std::min(most_m, random_.uniform(kMinRoomM, kMaxRoomM));
      Room room{{{at_m, depth.from_m}, {end_m, depth.to_m}}, {low_face, add_face(0, -1, end_m)}};
      room.faces[2] = north ? inner : outer;
      room.faces[3] = north ? outer : inner;
      const double width_m = random_.uniform(0.85, 1.0);
      const double from_m = random_.uniform(at_m + kDoorMarginM, end_m - kDoorMarginM - width_m);
      doors_.push_back({plan_.rooms.size(), north, {from_m, from_m + width_m}, random_.uniform(2.0, 2.1)});
      plan_.rooms.push_back(room);
      at_m = end_m + wall_m;
      if (!is_last)
        low_face = add_face(0, +1, at_m);
      else
        break;
    }
  }

  void add_corridor() {
    Room corridor{{{ends_.from_m, corridor_.from_m}, {ends_.to_m, corridor_.to_m}}, {}, /*furnished=*/false};
    corridor.faces = {add_face(0, +1, ends_.from_m), add_face(0, -1, ends_.to_m), add_face(1, +1, corridor_.from_m),
                      add_face(1, -1, corridor_.to_m)};
    wing_.corridor = plan_.rooms.size();
    plan_.rooms.push_back(corridor);
    for (const RoomDoor& door : doors_) add_door(door);
  }

  struct RoomDoor {
    std::size_t room = 0;
    bool north = false;
    Span along_x;
    double height_m = 0.0;
  };

  void add_door(const RoomDoor& door) {
    const Rectangle& floor = plan_.rooms[door.room].floor;
    if (door.north) {
      plan_.doors.push_back({1, corridor_.to_m, floor.min_m.y(), door.along_x.from_m, door.along_x.to_m, door.height_m,
                             wing_.corridor, door.room});
    } else {
      plan_.doors.push_back({1, floor.max_m.y(), corridor_.from_m, door.along_x.from_m, door.along_x.to_m,
                             door.height_m, door.room, wing_.corridor});
    }
  }

  void add_passage(const Passage& passage) {
    Room room{{{passage.along_x.from_m, passage.along_y.from_m}, {passage.along_x.to_m, passage.along_y.to_m}},
              {passage.low_face, passage.high_face, kOpenSide, kOpenSide},
              /*furnished=*/false};
    room.faces[passage.north ? 2 : 3] = passage.corridor_face;
    const Span portal{passage.along_x.from_m + kPortalMarginM, passage.along_x.to_m - kPortalMarginM};
    plan_.rooms.push_back(room);
    add_door({plan_.rooms.size() - 1, passage.north, portal, kPortalHeightM});
    (passage.north ? wing_.exit_m : wing_.entrance_m) = {passage.along_x.middle_m(), corridor_.middle_m()};
  }

  void add_stops() {
    if (number_ == 0) wing_.entrance_m = {ends_.from_m + 1.0, corridor_.middle_m()};
    for (std::size_t i = 0; i < doors_.size(); ++i) wing_.stops.push_back(i);
    std::sort(wing_.stops.begin(), wing_.stops.end(), [this](std::size_t a, std::size_t b) {
      const double a_m = doors_[a].along_x.from_m;
      const double b_m = doors_[b].along_x.from_m;
      return wing_.upwards ? a_m < b_m : a_m > b_m;
    });
  }

  std::uint64_t seed_;
  std::size_t number_;
  Random random_;
  Span corridor_;         // along y
  Span ends_{1e9, -1e9};  // of all, along x
  std::vector<RoomDoor> doors_;
  std::vector<Passage> passages_;
  FloorPlan plan_;
  Wing wing_;
};

}  // namespace

Wing make_wing(std::uint64_t seed, std::size_t number) {
  Wing wing = WingPlanner(seed, number).plan();
  Random random(seed, wing_stream(number) + (std::uint64_t{1} << 32U));
  for (int attempt = 0; attempt < kMaxTries && wing.apartment.furniture.empty(); ++attempt) {
    wing.apartment.furniture = make_furniture(wing.apartment.plan, random);
  }
  if (wing.apartment.furniture.empty()) throw std::runtime_error("make_wing: no room for the furniture in 100 tries");
  Random place(seed, boundary_stream(0) + 1'000'000'007U);
  wing.apartment.T_world_apartment = random_placement(place);
  return wing;
}

}  // namespace planemap::simulation

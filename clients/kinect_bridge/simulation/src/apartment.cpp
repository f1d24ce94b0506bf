#include "apartment.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>

namespace planemap::simulation {
namespace {

constexpr double kTiltRad = 0.0175;  // one degree
constexpr int kMaxTries = 1000;

Eigen::Vector3d axis_vector(int axis, double sign) {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  v[axis] = sign;
  return v;
}

/// A point on a wall's face.
Eigen::Vector2d on_wall(int axis, double position_m, double along_m) {
  Eigen::Vector2d p_m;
  p_m[axis] = position_m;
  p_m[1 - axis] = along_m;
  return p_m;
}

/// The pieces of one side of a room's wall: beside the doors from floor to ceiling, above them the lintels.
void add_wall_pieces(const FloorPlan& plan, std::size_t room_index, std::size_t face_index,
                     std::vector<ConvexPiece>& out) {
  const WallFace& face = plan.wall_faces[face_index];
  const Room& room = plan.rooms[room_index];
  std::map<double, const Door*> doors;  // along the wall
  for (const Door& door : plan.doors) {
    const bool low = door.low_room == room_index && door.low_m == face.position_m;
    const bool high = door.high_room == room_index && door.high_m == face.position_m;
    if (door.axis == face.axis && (low || high)) doors[door.from_m] = &door;
  }
  const auto piece = [&](double from_m, double to_m, double bottom_m) {
    out.push_back(upright_piece(on_wall(face.axis, face.position_m, from_m), on_wall(face.axis, face.position_m, to_m),
                                bottom_m, plan.height_m));
  };
  double from_m = room.floor.min_m[1 - face.axis];
  for (const auto& entry : doors) {
    const Door& door = *entry.second;
    piece(from_m, door.from_m, 0.0);
    piece(door.from_m, door.to_m, door.height_m);
    from_m = door.to_m;
  }
  piece(from_m, room.floor.max_m[1 - face.axis], 0.0);
}

/// Floor, ceiling and walls: each one surface, through all rooms that it borders.
void add_shell(const FloorPlan& plan, SurfaceBuilder& builder) {
  std::vector<ConvexPiece> floor;
  std::vector<ConvexPiece> ceiling;
  for (const Room& room : plan.rooms) {
    floor.push_back(level_piece(Footprint::of(room.floor), 0.0));
    ceiling.push_back(level_piece(Footprint::of(room.floor), plan.height_m));
  }
  for (const Door& door : plan.doors) floor.push_back(level_piece(Footprint::of(door.threshold()), 0.0));
  builder.add("floor", PlaneClass::kFloor, Eigen::Vector3d::UnitZ(), floor);
  builder.add("ceiling", PlaneClass::kCeiling, -Eigen::Vector3d::UnitZ(), ceiling);

  for (std::size_t face = 0; face < plan.wall_faces.size(); ++face) {
    std::vector<ConvexPiece> pieces;
    for (std::size_t room = 0; room < plan.rooms.size(); ++room) {
      const auto& faces = plan.rooms[room].faces;
      if (std::find(faces.begin(), faces.end(), face) != faces.end()) add_wall_pieces(plan, room, face, pieces);
    }
    if (pieces.empty()) continue;
    builder.add("wall " + std::to_string(face + 1), PlaneClass::kWall,
                axis_vector(plan.wall_faces[face].axis, plan.wall_faces[face].sign), pieces);
  }
}

/// What is seen within the thickness of a wall: the sides and the upper end of the opening.
void add_door_frame(const Door& door, const std::string& name, SurfaceBuilder& builder) {
  const auto jamb = [&](const char* which, double along_m, double sign) {
    builder.add(name + which, PlaneClass::kWall, axis_vector(1 - door.axis, sign),
                {upright_piece(on_wall(door.axis, door.low_m, along_m), on_wall(door.axis, door.high_m, along_m), 0.0,
                               door.height_m)});
  };
  jamb(" left jamb", door.from_m, +1.0);
  jamb(" right jamb", door.to_m, -1.0);
  builder.add(name + " lintel", PlaneClass::kOther, -Eigen::Vector3d::UnitZ(),
              {level_piece(Footprint::of(door.threshold()), door.height_m)});
}

/// A board from the floor up to the wall, closed at its sides.
void add_board(const Furniture& board, const std::string& name, SurfaceBuilder& builder) {
  const auto corners_m = board.footprint.corners_m();  // back left, back right, front right, front left
  const auto at = [](const Eigen::Vector2d& p_m, double height_m) {
    return Eigen::Vector3d(p_m.x(), p_m.y(), height_m);
  };
  const Eigen::Vector3d back_left_m = at(corners_m[0], board.top_m);
  const Eigen::Vector3d back_right_m = at(corners_m[1], board.top_m);
  const Eigen::Vector3d front_right_m = at(corners_m[2], 0.0);
  const Eigen::Vector3d front_left_m = at(corners_m[3], 0.0);
  const Eigen::Vector3d normal = (front_right_m - front_left_m).cross(back_left_m - front_left_m).normalized();
  const double upwards = normal.z() > 0.0 ? 1.0 : -1.0;
  builder.add(name, PlaneClass::kSlope, upwards * normal, {{back_left_m, back_right_m, front_right_m, front_left_m}});
  const Eigen::Vector3d right = at(board.footprint.axis(0), 0.0);
  builder.add(name + " right side", PlaneClass::kWall, right, {{back_right_m, at(corners_m[1], 0.0), front_right_m}});
  builder.add(name + " left side", PlaneClass::kWall, -right, {{back_left_m, at(corners_m[0], 0.0), front_left_m}});
}

void add_furniture(const Furniture& item, const std::string& number, SurfaceBuilder& builder) {
  BoxFaces against_wall;
  against_wall.low_y = false;
  against_wall.low_x = item.low_side_free;
  against_wall.high_x = item.high_side_free;
  switch (item.kind) {
    case FurnitureKind::kTable:
      builder.add_table("table " + number, item.footprint, item.top_m);
      return;
    case FurnitureKind::kSlantedBoard:
      add_board(item, "slanted board " + number, builder);
      return;
    case FurnitureKind::kLowCabinet:
      builder.add_box("low cabinet " + number, item.footprint, item.bottom_m, item.top_m, against_wall,
                      PlaneClass::kTable);
      return;
    case FurnitureKind::kTallCabinet:
      against_wall.top = false;  // above eye level
      builder.add_box("tall cabinet " + number, item.footprint, item.bottom_m, item.top_m, against_wall,
                      PlaneClass::kTable);
      return;
    case FurnitureKind::kDoorLeaf: {
      BoxFaces leaf;
      leaf.top = false;
      builder.add_box("door leaf " + number, item.footprint, item.bottom_m, item.top_m, leaf, PlaneClass::kOther);
      return;
    }
  }
}

}  // namespace

Eigen::Isometry3d random_placement(Random& random) {
  const double yaw_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double tilt_axis_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector3d tilt_axis(std::cos(tilt_axis_rad), std::sin(tilt_axis_rad), 0.0);
  Eigen::Isometry3d T_world_scene = Eigen::Isometry3d::Identity();
  T_world_scene.linear() =
      (Eigen::AngleAxisd(kTiltRad, tilt_axis) * Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  T_world_scene.translation() =
      Eigen::Vector3d{random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), random.uniform(-0.5, 0.5)};
  return T_world_scene;
}

Apartment make_apartment(Random& random) {
  Apartment apartment;
  for (int attempt = 0; attempt < kMaxTries && apartment.furniture.empty(); ++attempt) {
    apartment.plan = make_floor_plan(random);
    apartment.furniture = make_furniture(apartment.plan, random);
  }
  if (apartment.furniture.empty()) throw std::runtime_error("make_apartment: no room for the furniture in 1000 tries");
  apartment.T_world_apartment = random_placement(random);
  return apartment;
}

void add_surfaces(const Apartment& apartment, SurfaceBuilder& builder) {
  add_shell(apartment.plan, builder);
  for (std::size_t i = 0; i < apartment.plan.doors.size(); ++i) {
    add_door_frame(apartment.plan.doors[i], "door " + std::to_string(i + 1), builder);
  }
  std::map<FurnitureKind, int> count;
  for (const Furniture& item : apartment.furniture) {
    add_furniture(item, std::to_string(++count[item.kind]), builder);
  }
}

std::vector<Surface> make_surfaces(const Apartment& apartment) {
  SurfaceBuilder builder(apartment.T_world_apartment);
  add_surfaces(apartment, builder);
  return builder.take();
}

}  // namespace planemap::simulation

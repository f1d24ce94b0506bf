#include "walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../free_space.hpp"

namespace planemap::simulation {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInsideM = 0.6;          // from the door to where the robot is in the room
constexpr double kBorderM = 1.0;          // from the next wing, where this one's part of the way ends
constexpr double kLeastClearanceM = 0.3;  // of paths within a room
constexpr std::size_t kKept = 40;         // samples behind the camera: two seconds

double rad(double deg) {
  return deg * kPi / 180.0;
}
double wave(double time_s, double period_s) {
  return std::sin(2.0 * kPi * time_s / period_s);
}
double direction_rad(const Eigen::Vector2d& v) {
  return std::atan2(v.y(), v.x());
}

/// Where one can be in a room among its furniture.
FreeSpace free_space_of(const Rectangle& floor, const std::vector<Furniture>& furniture) {
  const Footprint room = Footprint::of(floor);
  std::vector<Footprint> obstacles;
  for (const Furniture& item : furniture) {
    if (overlap(item.footprint, room)) obstacles.push_back(item.footprint);
  }
  for (int axis = 0; axis < 2; ++axis) {
    for (const Eigen::Vector2d& corner_m : {floor.min_m, floor.max_m}) {
      Footprint wall = room;
      wall.centre_m[axis] = corner_m[axis];
      wall.half_size_m[axis] = 1e-3;
      obstacles.push_back(wall);
    }
  }
  return FreeSpace(floor, obstacles);
}

/// Appends a robot's samples, as fast as it drives and turns.
class Driver {
 public:
  Driver(std::deque<CameraSample>& raw, std::size_t first) : raw_(raw), first_(first) {}

  /// Straight on, looking ahead, to the left and to the right.
  void drive_to(const Eigen::Vector2d& goal_m) {
    if (raw_.empty()) sample(goal_m, 0.0, 0.0);
    const Eigen::Vector2d from_m = position_m();
    const Eigen::Vector2d way_m = goal_m - from_m;
    const auto steps = static_cast<int>(std::ceil(way_m.norm() / (kSpeedMPerS * kSampleS)));
    for (int i = 1; i <= steps; ++i) {
      sample(from_m + way_m * i / steps, direction_rad(way_m) + rad(40.0) * wave(time_s(), 6.0),
             rad(-6.0) + rad(16.0) * wave(time_s(), 5.3));
    }
  }

  /// Once about itself: up to the ceiling for the first half of each look, down for the other.
  void turn_round() {
    const double from_rad = raw_.back().yaw_rad;
    const auto steps = static_cast<int>(2.0 * kPi / (kTurnRadPerS * kSampleS));
    for (int i = 0; i <= steps; ++i) {
      sample(position_m(), from_rad + i * kTurnRadPerS * kSampleS, rad(-3.0) + rad(22.0) * wave(time_s(), 4.3));
    }
  }

  Eigen::Vector2d position_m() const { return raw_.back().position_m.head<2>(); }

 private:
  double time_s() const { return kSampleS * static_cast<double>(first_ + raw_.size()); }

  void sample(const Eigen::Vector2d& position_m, double wanted_yaw_rad, double pitch_rad) {
    const double yaw_rad = raw_.empty() ? wanted_yaw_rad : raw_.back().yaw_rad;
    const double most_rad = kMaxTurnRadPerS * kSampleS;
    CameraSample next;
    next.position_m << position_m, kCameraHeightM + kCameraHeightSwayM * wave(time_s(), 23.0);
    next.yaw_rad = yaw_rad + std::clamp(std::remainder(wanted_yaw_rad - yaw_rad, 2.0 * kPi), -most_rad, most_rad);
    next.pitch_rad = pitch_rad;
    raw_.push_back(next);
  }

  std::deque<CameraSample>& raw_;
  std::size_t first_;  // number of raw_'s first sample
};

/// Into a room, to where there is most space, and back into the corridor.
void visit(const Wing& wing, std::size_t room, double corridor_m, Driver& driver) {
  const FloorPlan& plan = wing.apartment.plan;
  const Door& door = plan.doors[room];
  const Rectangle& floor = plan.rooms[room].floor;
  const double along_m = 0.5 * (door.from_m + door.to_m);
  const bool north = door.high_room == room;
  const Eigen::Vector2d before_m(along_m, corridor_m);
  const Eigen::Vector2d inside_m(along_m, north ? door.high_m + kInsideM : door.low_m - kInsideM);
  const FreeSpace space = free_space_of(floor, wing.apartment.furniture);
  const std::vector<Eigen::Vector2d> path_m = space.path(inside_m, space.roomiest(floor), kLeastClearanceM);
  driver.drive_to(before_m);
  driver.drive_to(inside_m);
  for (std::size_t i = 4; i < path_m.size(); i += 4) driver.drive_to(path_m[i]);
  driver.turn_round();
  for (std::size_t i = (path_m.size() + 3) / 4; i-- > 1;) driver.drive_to(path_m[4 * i]);
  driver.drive_to(inside_m);
  driver.drive_to(before_m);
}

}  // namespace

Walk::Walk(std::uint64_t seed) : seed_(seed) {
  const auto reach = static_cast<int>(3.0 * kSmoothingS / kSampleS);
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    weights_.push_back(std::exp(-0.5 * std::pow(k * kSampleS / kSmoothingS, 2)));
    sum += weights_.back();
  }
  for (double& weight : weights_) weight /= sum;
}

void Walk::go_through_next_wing() {
  const Wing wing = make_wing(seed_, wing_);
  const double border_m = kWingPitchM * static_cast<double>(wing_);
  Driver driver(raw_, first_raw_);
  if (wing_ > 0) driver.drive_to({wing.entrance_m.x(), border_m + kBorderM});
  driver.drive_to(wing.entrance_m);
  for (const std::size_t room : wing.stops) visit(wing, room, wing.entrance_m.y(), driver);
  driver.drive_to(wing.exit_m);
  driver.drive_to({wing.exit_m.x(), border_m + kWingPitchM - kBorderM});
  ++wing_;
}

const CameraSample& Walk::smoothed(std::size_t index) {
  const std::size_t reach = weights_.size() / 2;
  while (first_smoothed_ + smoothed_.size() <= index) {
    const std::size_t at = first_smoothed_ + smoothed_.size();
    while (first_raw_ + raw_.size() <= at + reach) go_through_next_wing();
    CameraSample mean;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const std::size_t wanted = at + k < first_raw_ + reach ? first_raw_ : at + k - reach;  // stands before the first
      const CameraSample& raw = raw_[wanted - first_raw_];
      mean.position_m += weights_[k] * raw.position_m;
      mean.yaw_rad += weights_[k] * raw.yaw_rad;
      mean.pitch_rad += weights_[k] * raw.pitch_rad;
    }
    smoothed_.push_back(mean);
    if (at > reach + 1 && at - reach - 1 > first_raw_) {
      raw_.pop_front();
      ++first_raw_;
    }
    if (smoothed_.size() > kKept) {
      smoothed_.pop_front();
      ++first_smoothed_;
    }
  }
  return smoothed_[std::max(index, first_smoothed_) - first_smoothed_];
}

Eigen::Isometry3d Walk::T_scene_sensor(double time_s) {
  const double at = time_s / kSampleS;
  const auto first = static_cast<std::size_t>(at);
  const CameraSample a = smoothed(first);
  return simulation::T_scene_sensor(between(a, smoothed(first + 1), at - static_cast<double>(first)));
}

}  // namespace planemap::simulation

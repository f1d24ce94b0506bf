#include "tour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "free_space.hpp"

namespace planemap::simulation {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLeastClearanceM = 0.3;  // of planned paths; smoothing cuts corners by up to 0.1 m
constexpr double kViewClearanceM = 0.4;   // of the points that are aimed at
constexpr double kWallDistanceM = 0.6;    // when driving along the walls
constexpr double kViewDistanceM = 1.5;    // from something that is gone to be looked at
constexpr double kViewS = 5.0;

double rad(double deg) {
  return deg * kPi / 180.0;
}

/// A periodic motion between -1 and 1.
double wave(double time_s, double period_s) {
  return std::sin(2.0 * kPi * time_s / period_s);
}

double direction_rad(const Eigen::Vector2d& v) {
  return std::atan2(v.y(), v.x());
}

std::vector<Footprint> obstacles_of(const Apartment& apartment) {
  std::vector<Footprint> obstacles = apartment.plan.walls;
  for (const Furniture& item : apartment.furniture) obstacles.push_back(item.footprint);
  return obstacles;
}

}  // namespace

/// Puts the tour together, sample by sample.
class TourPlanner {
 public:
  TourPlanner(const Apartment& apartment, const std::vector<View>& views)
      : plan_(apartment.plan), views_(views), free_space_(plan_.outline, obstacles_of(apartment)) {}

  /// One round; empty if a room can't be reached.
  std::vector<CameraSample> drive() {
    const std::vector<std::size_t> order = rooms_in_order();
    const Eigen::Vector2d start_m = free_space_.roomiest(plan_.rooms[order.front()].floor);
    position_m_ = start_m;
    for (const std::size_t room : order) visit(plan_.rooms[room].floor);
    go_to(start_m);
    if (!reachable_) return {};
    turn_to(raw_.front().yaw_rad);
    return std::move(raw_);
  }

  double least_clearance_m(const std::vector<CameraSample>& samples) const {
    double least_m = kLeastClearanceM;
    for (const CameraSample& sample : samples) {
      least_m = std::min(least_m, free_space_.clearance_m(sample.position_m.head<2>()));
    }
    return least_m;
  }

 private:
  /// Depth first through the doors, so that the robot does not cross the apartment between two rooms.
  std::vector<std::size_t> rooms_in_order() const {
    std::vector<std::size_t> order;
    std::vector<std::size_t> open = {0};
    while (!open.empty()) {
      const std::size_t room = open.back();
      open.pop_back();
      if (std::find(order.begin(), order.end(), room) != order.end()) continue;
      order.push_back(room);
      for (const Door& door : plan_.doors) {
        if (door.low_room == room) open.push_back(door.high_room);
        if (door.high_room == room) open.push_back(door.low_room);
      }
    }
    return order;
  }

  double time_s() const { return kSampleS * static_cast<double>(raw_.size()); }

  /// Stays or moves on by a sample and turns as far as the robot can towards a direction.
  void sample(const Eigen::Vector2d& position_m, double wanted_yaw_rad, double pitch_rad) {
    const double yaw_rad = raw_.empty() ? wanted_yaw_rad : raw_.back().yaw_rad;
    const double most_rad = kMaxTurnRadPerS * kSampleS;
    const double step_rad = std::clamp(std::remainder(wanted_yaw_rad - yaw_rad, 2.0 * kPi), -most_rad, most_rad);
    CameraSample next;
    next.position_m << position_m, kCameraHeightM + kCameraHeightSwayM * wave(time_s(), 23.0);
    next.yaw_rad = yaw_rad + step_rad;
    next.pitch_rad = pitch_rad;
    raw_.push_back(next);
    position_m_ = position_m;
  }

  void visit(const Rectangle& room) {
    go_to(free_space_.roomiest(room));
    turn_round();
    // The corners of the room, beginning with the nearest.
    const Eigen::Vector2d inset_m = Eigen::Vector2d::Constant(kWallDistanceM);
    const Eigen::Vector2d low_m = room.min_m + inset_m;
    const Eigen::Vector2d high_m = room.max_m - inset_m;
    std::array<Eigen::Vector2d, 4> corners_m = {low_m, Eigen::Vector2d(high_m.x(), low_m.y()), high_m,
                                                Eigen::Vector2d(low_m.x(), high_m.y())};
    const auto nearest = std::min_element(corners_m.begin(), corners_m.end(), [this](const auto& a, const auto& b) {
      return (a - position_m_).squaredNorm() < (b - position_m_).squaredNorm();
    });
    std::rotate(corners_m.begin(), nearest, corners_m.end());
    for (const Eigen::Vector2d& corner_m : corners_m) drive_to(corner_m, room);
    drive_to(corners_m.front(), room);
    for (const View& view : views_) {
      // A hand's breadth in front of a wall one is in its room.
      if (room.contains((view.point_m + 0.05 * view.normal).head<2>(), 0.0)) go_and_see(view, room);
    }
  }

  /// Once about itself: up to the ceiling for the first half of each look, down for the other.
  void turn_round() {
    const double from_rad = raw_.empty() ? 0.0 : raw_.back().yaw_rad;
    const auto steps = static_cast<int>(2.0 * kPi / (kTurnRadPerS * kSampleS));
    for (int i = 0; i <= steps; ++i) {
      sample(position_m_, from_rad + i * kTurnRadPerS * kSampleS, rad(6.0) + rad(17.0) * wave(time_s(), 4.3));
    }
  }

  void turn_to(double yaw_rad) {
    while (std::abs(std::remainder(raw_.back().yaw_rad - yaw_rad, 2.0 * kPi)) > 1e-9) sample(position_m_, yaw_rad, 0.0);
  }

  /// Along a path at constant speed, looking as told.
  template <class Look>
  void follow(const std::vector<Eigen::Vector2d>& path_m, const Look& look) {
    if (path_m.empty()) reachable_ = false;
    const double step_m = kSpeedMPerS * kSampleS;
    double left_m = step_m;  // until the next sample
    for (std::size_t i = 1; i < path_m.size(); ++i) {
      const Eigen::Vector2d leg_m = path_m[i] - path_m[i - 1];
      const double length_m = leg_m.norm();
      double done_m = left_m;
      while (done_m <= length_m) {
        look(Eigen::Vector2d(path_m[i - 1] + done_m / length_m * leg_m), leg_m);
        done_m += step_m;
      }
      left_m = done_m - length_m;
    }
  }

  /// Into another room: looks ahead, to the left and to the right.
  void go_to(const Eigen::Vector2d& goal_m) {
    if ((goal_m - position_m_).norm() < kSpeedMPerS * kSampleS) return;
    follow(free_space_.path(position_m_, goal_m, kLeastClearanceM), [this](const Eigen::Vector2d& p_m,
                                                                           const Eigen::Vector2d& leg_m) {
      sample(p_m, direction_rad(leg_m) + rad(40.0) * wave(time_s(), 6.0), rad(-6.0) + rad(16.0) * wave(time_s(), 5.3));
    });
  }

  /// Within a room: looks across it, and in each corner from one wall to the other.
  void drive_to(const Eigen::Vector2d& wish_m, const Rectangle& room) {
    const auto goal_m = free_space_.nearest_free(wish_m, room, kViewClearanceM);
    if (!goal_m || (*goal_m - position_m_).norm() < kSpeedMPerS * kSampleS) return;
    const Eigen::Vector2d centre_m = room.centre_m();
    const auto pitch_rad = [this] { return rad(-11.0) + rad(19.0) * wave(time_s(), 5.3); };
    follow(free_space_.path(position_m_, *goal_m, kLeastClearanceM),
           [&](const Eigen::Vector2d& p_m, const Eigen::Vector2d&) {
             sample(p_m, direction_rad(centre_m - p_m) + rad(60.0) * wave(time_s(), 7.0), pitch_rad());
           });
    const double across_rad = direction_rad(centre_m - position_m_);
    for (const double end_rad : {across_rad - rad(75.0), across_rad + rad(75.0)}) {
      while (std::abs(std::remainder(raw_.back().yaw_rad - end_rad, 2.0 * kPi)) > 1e-9) {
        sample(position_m_, end_rad, pitch_rad());
      }
    }
  }

  /// Stops in front of something, or beside it if it lies level, and looks at it.
  void go_and_see(const View& view, const Rectangle& room) {
    const Eigen::Vector2d target_m = view.point_m.head<2>();
    const auto goal_m =
        free_space_.nearest_free(target_m + kViewDistanceM * view.normal.head<2>(), room, kViewClearanceM);
    if (!goal_m) return;
    go_to(*goal_m);
    const Eigen::Vector2d to_target_m = target_m - position_m_;
    const double pitch_rad = std::atan2(view.point_m.z() - kCameraHeightM, to_target_m.norm());
    turn_to(direction_rad(to_target_m));
    const auto steps = static_cast<int>(kViewS / kSampleS);
    for (int i = 0; i <= steps; ++i) {
      sample(position_m_, direction_rad(to_target_m) + rad(12.0) * wave(i * kSampleS, kViewS),
             std::clamp(pitch_rad, rad(-40.0), rad(40.0)));
    }
  }

  const FloorPlan& plan_;
  const std::vector<View>& views_;
  FreeSpace free_space_;
  std::vector<CameraSample> raw_;
  Eigen::Vector2d position_m_ = Eigen::Vector2d::Zero();
  bool reachable_ = true;
};

Tour::Tour(const std::vector<CameraSample>& raw)
    : samples_(raw.size()),
      turn_rad_(2.0 * kPi * std::round((raw.back().yaw_rad - raw.front().yaw_rad) / (2.0 * kPi))) {
  const auto reach = static_cast<int>(3.0 * kSmoothingS / kSampleS);
  const auto count = static_cast<int>(raw.size());
  std::vector<double> weights;
  double weight_sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-0.5 * std::pow(k * kSampleS / kSmoothingS, 2)));
    weight_sum += weights.back();
  }
  for (int i = 0; i < count; ++i) {
    for (int k = -reach; k <= reach; ++k) {
      // The neighbours of the ends are in the rounds before and after: division that rounds down.
      const int rounds = (i + k >= 0 ? i + k : i + k - count + 1) / count;
      const CameraSample& neighbour = raw[static_cast<std::size_t>(i + k - rounds * count)];
      const double weight = weights[k + reach] / weight_sum;
      samples_[i].position_m += weight * neighbour.position_m;
      samples_[i].yaw_rad += weight * (neighbour.yaw_rad + rounds * turn_rad_);
      samples_[i].pitch_rad += weight * neighbour.pitch_rad;
    }
  }
}

std::optional<Tour> Tour::plan(const Apartment& apartment, const std::vector<View>& views) {
  TourPlanner planner(apartment, views);
  const std::vector<CameraSample> raw = planner.drive();
  if (raw.empty()) return std::nullopt;
  const Tour tour(raw);
  if (planner.least_clearance_m(tour.samples_) < 0.5 * kLeastClearanceM) return std::nullopt;
  return tour;
}

void Tour::go_on(const CameraSample& goal, std::vector<CameraSample>& raw) {
  const CameraSample start = raw.back();
  const Eigen::Vector3d way_m = goal.position_m - start.position_m;
  const double yaw_rad = std::remainder(goal.yaw_rad - start.yaw_rad, 2.0 * kPi);
  const double pitch_rad = goal.pitch_rad - start.pitch_rad;
  const double time_s =
      std::max({way_m.norm() / kSpeedMPerS, std::abs(yaw_rad) / kTurnRadPerS, std::abs(pitch_rad) / kTurnRadPerS});
  const int steps = std::max(1, static_cast<int>(std::ceil(time_s / kSampleS)));
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    raw.push_back(
        {start.position_m + share * way_m, start.yaw_rad + share * yaw_rad, start.pitch_rad + share * pitch_rad});
  }
}

Tour Tour::through(const std::vector<Station>& stations) {
  const auto sample_at = [](const Station& station) {
    const Eigen::Vector3d view_m = station.target_m - station.position_m;
    return CameraSample{station.position_m, direction_rad(view_m.head<2>()),
                        std::atan2(view_m.z(), view_m.head<2>().norm())};
  };
  std::vector<CameraSample> raw = {sample_at(stations.front())};
  for (std::size_t i = 1; i < stations.size(); ++i) go_on(sample_at(stations[i]), raw);
  go_on(sample_at(stations.front()), raw);
  return Tour(raw);
}

double Tour::duration_s() const {
  return kSampleS * static_cast<double>(samples_.size());
}

Eigen::Isometry3d Tour::T_scene_sensor(double time_s) const {
  const double rounds = std::floor(time_s / duration_s());
  const double at = (time_s - rounds * duration_s()) / kSampleS;
  const std::size_t first = std::min(static_cast<std::size_t>(at), samples_.size() - 1);
  const bool last = first + 1 == samples_.size();
  const CameraSample& a = samples_[first];
  const CameraSample& b = samples_[last ? 0 : first + 1];
  CameraSample next = b;
  if (last) next.yaw_rad += turn_rad_;
  return simulation::T_scene_sensor(between(a, next, at - static_cast<double>(first)));
}

}  // namespace planemap::simulation

#include "rooms.hpp"

namespace planemap::simulation {
namespace {

constexpr int kSteps = 5;
constexpr double kRiseM = 0.17;
constexpr double kGoingM = 0.28;
constexpr double kWidthM = 1.8;
constexpr double kBeginM = 2.2;  // of the first riser
constexpr double kEndM = 5.0;    // of the landing, which is the last tread

void add_stairs(SurfaceBuilder& builder) {
  for (int i = 0; i < kSteps; ++i) {
    const bool last = i + 1 == kSteps;
    const std::string number = std::to_string(i + 1);
    const double y_m = kBeginM + i * kGoingM;
    const double top_m = (i + 1) * kRiseM;
    builder.add("riser " + number, PlaneClass::kOther, -Eigen::Vector3d::UnitY(),
                {upright_piece({0.0, y_m}, {kWidthM, y_m}, top_m - kRiseM, top_m)});
    builder.add(last ? "landing" : "tread " + number, PlaneClass::kOther, Eigen::Vector3d::UnitZ(),
                {level_piece(Footprint::of({{0.0, y_m}, {kWidthM, last ? kEndM : y_m + kGoingM}}), top_m)});
  }
}

}  // namespace

Scene make_stairs(Random& random) {
  const Apartment room = empty_room({kWidthM, kEndM, 3.2}, random);  // its floor goes on under the stairs
  SurfaceBuilder builder(room.T_world_apartment);
  add_surfaces(room, builder);
  add_stairs(builder);
  const std::vector<Station> stations = {{{0.9, 0.6, 1.2}, {0.9, 2.6, 0.3}}, {{0.5, 1.0, 1.2}, {0.7, 2.8, 0.4}},
                                         {{1.3, 1.2, 1.2}, {1.1, 2.9, 0.5}}, {{0.9, 1.7, 1.3}, {0.9, 3.2, 0.7}},
                                         {{0.7, 2.3, 1.5}, {0.9, 3.8, 0.8}}, {{1.1, 1.7, 1.3}, {0.9, 3.0, 0.6}}};
  return {room.T_world_apartment, builder.take(), Tour::through(stations), 60};
}

}  // namespace planemap::simulation

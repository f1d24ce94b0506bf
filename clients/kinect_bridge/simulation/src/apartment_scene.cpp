#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "apartment.hpp"
#include "coverage.hpp"
#include "scene.hpp"

namespace planemap::simulation {
namespace {

constexpr int kMaxTries = 1000;

/// Where to look at a surface: its largest piece.
View view_of(const Surface& surface, const Eigen::Isometry3d& T_apartment_world) {
  const auto largest =
      std::max_element(surface.pieces_m.begin(), surface.pieces_m.end(),
                       [](const ConvexPiece& a, const ConvexPiece& b) { return area_m2(a) < area_m2(b); });
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner_m : *largest) middle_m += corner_m / static_cast<double>(largest->size());
  return {T_apartment_world * middle_m, T_apartment_world.linear() * surface.plane.normal()};
}

/// A tour that shows every large surface: what the plain one misses, the robot goes and looks at. Empty if there is
/// none.
std::optional<Tour> plan_tour(const Apartment& apartment, const std::vector<Surface>& surfaces) {
  constexpr int kRounds = 4;  // a longer tour is recorded in larger steps, and may miss something else
  const Eigen::Isometry3d T_apartment_world = apartment.T_world_apartment.inverse();
  std::vector<View> views;
  for (int round = 0; round < kRounds; ++round) {
    auto tour = Tour::plan(apartment, views);
    if (!tour) return std::nullopt;
    const std::vector<Surface> missed = poorly_seen(*tour, apartment, surfaces);
    if (missed.empty()) return tour;
    for (const Surface& surface : missed) views.push_back(view_of(surface, T_apartment_world));
  }
  return std::nullopt;
}

}  // namespace

Scene make_apartment_scene(Random& random) {
  for (int attempt = 0; attempt < kMaxTries; ++attempt) {
    Apartment apartment = make_apartment(random);
    std::vector<Surface> surfaces = make_surfaces(apartment);
    if (auto tour = plan_tour(apartment, surfaces)) {
      return {apartment.T_world_apartment, std::move(surfaces), std::move(*tour), std::nullopt};
    }
  }
  throw std::runtime_error("make_apartment_scene: no apartment that a robot can drive through and see in 1000 tries");
}

}  // namespace planemap::simulation

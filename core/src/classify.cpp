#include "planemap/classify.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planemap {
namespace {

// Ramps and boards lean by more; walls, floors and the gravity direction itself are out by a few degrees at most.
constexpr double kTiltRad = 15.0 * std::numbers::pi / 180.0;
constexpr double kLargeM2 = 0.5;       // smaller ones low down may be a step or a shelf
constexpr double kFloorHeightM = 0.3;  // steps between rooms, and what a lean of 1 degree gives over 15 m

enum class Facing { kUp, kDown, kSideways, kAslant };

Facing facing_of(const Plane& plane, const Eigen::Vector3d& up) {
  const double cosine = plane.normal().dot(up);
  if (cosine >= std::cos(kTiltRad)) return Facing::kUp;
  if (cosine <= -std::cos(kTiltRad)) return Facing::kDown;
  if (std::abs(cosine) <= std::sin(kTiltRad)) return Facing::kSideways;
  return Facing::kAslant;
}

/// Height of the lowest large up-facing surface, metres along up; empty: there is none.
std::optional<double> floor_height_m(std::span<const Surface> surfaces, const Eigen::Vector3d& up) {
  std::optional<double> lowest_m;
  for (const Surface& surface : surfaces) {
    if (surface.area_m2 < kLargeM2 || facing_of(surface.plane, up) != Facing::kUp) continue;
    const double height_m = surface.centroid_m.dot(up);
    lowest_m = std::min(lowest_m.value_or(height_m), height_m);
  }
  return lowest_m;
}

PlaneClass class_of(const Surface& surface, const Eigen::Vector3d& up, const std::optional<double>& floor_m) {
  switch (facing_of(surface.plane, up)) {
    case Facing::kDown:
      return PlaneClass::kCeiling;
    case Facing::kSideways:
      return PlaneClass::kWall;
    case Facing::kAslant:
      return PlaneClass::kSlope;
    case Facing::kUp:
      break;
  }
  const bool is_floor = floor_m && surface.centroid_m.dot(up) <= *floor_m + kFloorHeightM;
  return is_floor ? PlaneClass::kFloor : PlaneClass::kTable;
}

}  // namespace

std::vector<PlaneClass> classify(std::span<const Surface> surfaces, const std::optional<Eigen::Vector3d>& gravity) {
  std::vector<PlaneClass> classes(surfaces.size(), PlaneClass::kOther);
  if (!gravity) return classes;
  const Eigen::Vector3d up = -gravity->normalized();
  const std::optional<double> floor_m = floor_height_m(surfaces, up);
  std::transform(surfaces.begin(), surfaces.end(), classes.begin(),
                 [&](const Surface& surface) { return class_of(surface, up, floor_m); });
  return classes;
}

}  // namespace planemap

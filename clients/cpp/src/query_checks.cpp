#include "query_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace planemap::client {
namespace {

constexpr std::array<const char*, 6> kClasses = {"floor", "ceiling", "wall", "table", "slope", "other"};
constexpr std::int32_t kMostNearPlanes = 1000;  // for each point, as core has it
constexpr double kSymmetryTolerance = 1e-9;     // of the greatest element

tl::unexpected<Error> refused(std::string message) {
  return tl::make_unexpected(Error{Error::Kind::kRefused, std::move(message)});
}

std::string text_of(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", number);
  return text.data();
}

bool is_symmetric(const std::array<double, 9>& c) {
  double greatest = 0.0;
  for (const double element : c) greatest = std::max(greatest, std::abs(element));
  const double asymmetry = std::max({std::abs(c[1] - c[3]), std::abs(c[2] - c[6]), std::abs(c[5] - c[7])});
  return !(asymmetry > kSymmetryTolerance * greatest);
}

}  // namespace

Expected<void> check_filter(const PlaneFilter& filter) {
  for (const std::string& name : filter.classes) {
    if (std::find(kClasses.begin(), kClasses.end(), name) != kClasses.end()) continue;
    return refused("filter.classes: '" + name.substr(0, 32) +
                   "' is no class (floor, ceiling, wall, table, slope, other)");
  }
  if (!(filter.max_normal_deviation_rad > 0.0)) {
    return refused("filter.max_normal_deviation_rad: must be greater than 0, is " +
                   text_of(filter.max_normal_deviation_rad));
  }
  if (filter.epoch < 0) return refused("filter.epoch: must be at least 0, is " + std::to_string(filter.epoch));
  return {};
}

Expected<void> check_plane_id(std::int64_t id) {
  if (id <= 0) return refused("id: must be greater than 0, is " + std::to_string(id));
  return {};
}

Expected<void> check_query(std::span<const QueryPoint> points, const NearestOptions& options) {
  if (points.empty()) return refused("points: there must be one at least");
  if (options.count < 1 || options.count > kMostNearPlanes) {
    return refused("count: must be 1 to " + std::to_string(kMostNearPlanes) + ", is " + std::to_string(options.count));
  }
  if (!(options.max_distance_m > 0.0)) {
    return refused("max_distance_m: must be greater than 0, is " + text_of(options.max_distance_m));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto name = [i] { return "points[" + std::to_string(i) + "]."; };
    if (!std::isfinite(points[i].sigma_m) || points[i].sigma_m < 0.0) {
      return refused(name() + "sigma_m: must be finite and at least 0, is " + text_of(points[i].sigma_m));
    }
    if (!is_symmetric(points[i].covariance_m2)) return refused(name() + "covariance_m2: is not symmetric");
  }
  return check_filter(options.filter);
}

Expected<void> check_query(std::span<const Ray> rays, const CastOptions& options) {
  if (rays.empty()) return refused("rays: there must be one at least");
  if (!options.planes && !options.cells) return refused("planes, cells: one of them must be asked for");
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(rays[i].max_range_m > 0.0)) {
      return refused("rays[" + std::to_string(i) + "].max_range_m: must be greater than 0, is " +
                     text_of(rays[i].max_range_m));
    }
  }
  return check_filter(options.filter);
}

}  // namespace planemap::client

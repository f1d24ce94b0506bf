#include "codec/plane_cloud.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

namespace planemap::service {
namespace {

constexpr int kPointBytes = 16;
constexpr std::int8_t kUint32 = 6;
constexpr std::int8_t kFloat32 = 7;

/// Where an edge of a boundary crosses a row of the grid. Rows and columns run through (k + 1/2) spacings: a grid that
/// is wider than a plane has no point on it.
struct Crossing {
  std::int64_t row;
  double u_m;

  bool operator<(const Crossing& other) const { return row != other.row ? row < other.row : u_m < other.u_m; }
};

std::int64_t first_at_or_above(double coordinate_m, double spacing_m) {
  return static_cast<std::int64_t>(std::ceil(coordinate_m / spacing_m - 0.5));
}
double coordinate_of(std::int64_t k, double spacing_m) {
  return (static_cast<double>(k) + 0.5) * spacing_m;
}

/// An edge takes its lower end's row and not its upper one's: a corner on a row counts once, or twice where it turns.
void add_crossings(const Ring& ring, double spacing_m, std::vector<Crossing>& crossings) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Eigen::Vector2d low = ring[i];
    Eigen::Vector2d high = ring[(i + 1) % ring.size()];
    if (low.y() > high.y()) std::swap(low, high);
    const std::int64_t end = first_at_or_above(high.y(), spacing_m);
    for (std::int64_t row = first_at_or_above(low.y(), spacing_m); row < end; ++row) {
      const double share = (coordinate_of(row, spacing_m) - low.y()) / (high.y() - low.y());
      crossings.push_back({row, low.x() + share * (high.x() - low.x())});
    }
  }
}

/// Calls put(uv) for each point of the grid inside a polygon.
template <class Put>
void for_each_point(const Polygon& polygon, double spacing_m, const Put& put) {
  std::vector<Crossing> crossings;
  add_crossings(polygon.outer, spacing_m, crossings);
  for (const Ring& hole : polygon.holes) add_crossings(hole, spacing_m, crossings);
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    const std::int64_t end = first_at_or_above(crossings[i + 1].u_m, spacing_m);
    for (std::int64_t column = first_at_or_above(crossings[i].u_m, spacing_m); column < end; ++column) {
      put(Eigen::Vector2d(coordinate_of(column, spacing_m), coordinate_of(crossings[i].row, spacing_m)));
    }
  }
}

std::size_t count_points(std::span<const DescribedPlane> planes, double spacing_m) {
  std::size_t count = 0;
  for (const DescribedPlane& plane : planes) {
    for (const Polygon& polygon : plane.outline->polygons) {
      for_each_point(polygon, spacing_m, [&count](const Eigen::Vector2d&) { ++count; });
    }
  }
  return count;
}

/// The spacing with which the planes have no more than so many points.
double spacing_for(std::span<const DescribedPlane> planes, std::size_t max_points) {
  double sum_m2 = 0.0;
  for (const DescribedPlane& plane : planes) sum_m2 += area_m2(plane.outline->polygons);
  double spacing_m = std::max(kCloudSpacingM, std::sqrt(sum_m2 / static_cast<double>(max_points)));
  while (count_points(planes, spacing_m) > max_points) spacing_m *= 1.1;
  return spacing_m;
}

using Rgb = std::array<std::uint8_t, 3>;

/// Ids next to each other get hues far apart.
Rgb colour_of(PlaneId id) {
  const double hue = 6.0 * std::fmod(static_cast<double>(id) * 0.6180339887498949, 1.0);
  Rgb colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double distance = std::abs(std::fmod(hue + 6.0 - 2.0 * static_cast<double>(i) + 3.0, 6.0) - 3.0);
    colour[i] = static_cast<std::uint8_t>(40.0 + 200.0 * std::clamp(2.0 - distance, 0.0, 1.0));
  }
  return colour;
}

void append(std::vector<std::uint8_t>& bytes, float value) {
  const auto word = std::bit_cast<std::uint32_t>(value);
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(word >> shift));
}

void add_field(drake::lcmt_point_cloud& cloud, const char* name, std::int8_t datatype) {
  drake::lcmt_point_cloud_field field{};
  field.name = name;
  field.byte_offset = 4 * cloud.num_fields++;
  field.datatype = datatype;
  field.count = 1;
  cloud.fields.push_back(std::move(field));
}

}  // namespace

drake::lcmt_point_cloud to_point_cloud(std::span<const DescribedPlane> planes, std::int64_t utime,
                                       const std::string& frame, std::size_t max_points) {
  drake::lcmt_point_cloud cloud{};
  cloud.utime = utime;
  cloud.frame_name = frame;
  cloud.height = 1;
  for (const char* name : {"x", "y", "z"}) add_field(cloud, name, kFloat32);
  add_field(cloud, "rgb", kUint32);
  cloud.flags = drake::lcmt_point_cloud::IS_STRICTLY_FINITE;
  cloud.point_step = kPointBytes;
  const double spacing_m = spacing_for(planes, max_points);
  for (const DescribedPlane& plane : planes) {
    const Rgb colour = colour_of(plane.record->id);
    for (const Polygon& polygon : plane.outline->polygons) {
      for_each_point(polygon, spacing_m, [&](const Eigen::Vector2d& uv_m) {
        for (const double x : plane.outline->basis.to_world(uv_m)) append(cloud.data, static_cast<float>(x));
        cloud.data.insert(cloud.data.end(), colour.begin(), colour.end());
        cloud.data.push_back(0);
        ++cloud.width;
      });
    }
  }
  cloud.row_step = kPointBytes * cloud.width;
  cloud.data_size = static_cast<std::int64_t>(cloud.data.size());
  return cloud;
}

}  // namespace planemap::service

#include "lcm/wire_types.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace planemap::client {
namespace {

using planemap_lcm::cell_t;
using planemap_lcm::plane_t;
using planemap_lcm::polygon_t;
using planemap_lcm::status_t;

Vector3 floats_of(const float (&values)[3]) {
  return {values[0], values[1], values[2]};
}

/// The symmetric 4x4 whose upper triangle is given row by row.
std::array<double, 16> full_covariance(const double (&upper)[10]) {
  std::array<double, 16> full{};
  std::size_t next = 0;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = row; column < 4; ++column) {
      full[4 * row + column] = full[4 * column + row] = upper[next++];
    }
  }
  return full;
}

}  // namespace

Vector3 vector3_of(const double (&values)[3]) {
  return {values[0], values[1], values[2]};
}

Polygon polygon_of(const polygon_t& wire) {
  Polygon polygon;
  std::size_t next = 0;
  for (std::size_t i = 0; i < wire.ring_size.size(); ++i) {
    Ring ring(static_cast<std::size_t>(wire.ring_size[i]));
    for (auto& uv_m : ring) {
      uv_m = {wire.uv_m[next], wire.uv_m[next + 1]};
      next += 2;
    }
    if (i == 0) {
      polygon.outer = std::move(ring);
    } else {
      polygon.holes.push_back(std::move(ring));
    }
  }
  return polygon;
}

Plane plane_of(const plane_t& wire) {
  Plane plane;
  plane.id = wire.id;
  plane.normal = vector3_of(wire.normal);
  plane.d = wire.d;
  plane.covariance = full_covariance(wire.covariance);
  plane.centroid_m = vector3_of(wire.centroid_m);
  plane.area_m2 = wire.area_m2;
  plane.cell_count = wire.cell_count;
  plane.point_count = wire.point_count;
  plane.first_seen_utime = wire.first_seen_utime;
  plane.last_seen_utime = wire.last_seen_utime;
  plane.plane_class = wire.plane_class;
  plane.quality = wire.quality;
  plane.revision = wire.revision;
  plane.origin_m = vector3_of(wire.origin_m);
  plane.axis_u = vector3_of(wire.axis_u);
  plane.axis_v = vector3_of(wire.axis_v);
  std::transform(wire.polygons.begin(), wire.polygons.end(), std::back_inserter(plane.polygons), polygon_of);
  return plane;
}

Cell cell_of(const cell_t& wire) {
  Cell cell;
  cell.centre_m = floats_of(wire.centre_m);
  cell.sigma_m = floats_of(wire.sigma_m);
  cell.normal = floats_of(wire.normal);
  cell.deviation_rad = wire.deviation_rad;
  cell.count = wire.count;
  cell.plane_id = wire.plane_id;
  return cell;
}

Status status_of(const status_t& wire) {
  Status status;
  status.utime = wire.utime;
  status.version = wire.version;
  status.epoch = wire.epoch;
  status.revision = wire.revision;
  status.plane_count = wire.plane_count;
  status.cell_count = wire.cell_count;
  status.block_count = wire.block_count;
  status.scan_rate_hz = wire.scan_rate_hz;
  status.scan_ms_p50 = wire.scan_ms_p50;
  status.scan_ms_max = wire.scan_ms_max;
  status.last_scan_utime = wire.last_scan_utime;
  status.idle_reason = wire.idle_reason;
  status.degraded = wire.degraded;
  for (const auto& counter : wire.counters) status.counters[counter.name] = counter.value;
  return status;
}

}  // namespace planemap::client

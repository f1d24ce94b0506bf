#include "codec/plane_codec.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace planemap::service {
namespace {

using planemap_lcm::plane_t;
using planemap_lcm::polygon_t;
using UvRing = std::vector<Eigen::Vector2f>;

void copy(const Eigen::Vector3d& from, double (&to)[3]) {
  std::copy_n(from.data(), 3, to);
}
void copy(const Eigen::Vector3d& from, float (&to)[3]) {
  for (Eigen::Index i = 0; i < 3; ++i) to[i] = static_cast<float>(from[i]);
}

std::int32_t to_count(std::uint64_t count) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::min(count, kMost));
}

void append_ring(const Ring& ring, polygon_t& polygon) {
  polygon.ring_size.push_back(static_cast<std::int32_t>(ring.size()));
  for (const auto& uv_m : ring) {
    polygon.uv_m.push_back(static_cast<float>(uv_m.x()));
    polygon.uv_m.push_back(static_cast<float>(uv_m.y()));
  }
}

void set_counts(polygon_t& polygon) {
  polygon.n_rings = static_cast<std::int32_t>(polygon.ring_size.size());
  polygon.n_values = static_cast<std::int32_t>(polygon.uv_m.size());
}

template <class Item>
std::size_t encoded_bytes(const Item& item) {
  return static_cast<std::size_t>(item._getEncodedSizeNoHash());
}

std::size_t encoded_bytes(const std::vector<polygon_t>& polygons) {
  std::size_t sum = 0;
  for (const auto& polygon : polygons) sum += encoded_bytes(polygon);
  return sum;
}

/// Distance of p from the segment from a to b.
float distance(const Eigen::Vector2f& p, const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  const Eigen::Vector2f along = b - a;
  const float length2 = along.squaredNorm();
  const float share = length2 > 0.0F ? std::clamp((p - a).dot(along) / length2, 0.0F, 1.0F) : 0.0F;
  return (p - a - share * along).norm();
}

/// Douglas and Peucker between two kept corners; marks what is kept. A stack of its own, as a ring may have many
/// corners.
void keep_corners(const UvRing& ring, std::size_t first, std::size_t last, float tolerance_m, std::vector<bool>& kept) {
  std::vector<std::pair<std::size_t, std::size_t>> open = {{first, last}};
  while (!open.empty()) {
    const auto piece = open.back();
    open.pop_back();
    float farthest_m = tolerance_m;
    std::size_t corner = 0;
    for (std::size_t i = piece.first + 1; i < piece.second; ++i) {
      const float d = distance(ring[i], ring[piece.first], ring[piece.second % ring.size()]);
      if (d <= farthest_m) continue;
      farthest_m = d;
      corner = i;
    }
    if (corner == 0) continue;
    kept[corner] = true;
    open.emplace_back(piece.first, corner);
    open.emplace_back(corner, piece.second);
  }
}

/// The ring with fewer corners; empty where less than a triangle is left.
UvRing simplified(const UvRing& ring, float tolerance_m) {
  if (ring.size() < 4) return ring;
  std::size_t opposite = 0;
  for (std::size_t i = 1; i < ring.size(); ++i) {
    if ((ring[i] - ring[0]).squaredNorm() > (ring[opposite] - ring[0]).squaredNorm()) opposite = i;
  }
  std::vector<bool> kept(ring.size(), false);
  kept[0] = kept[opposite] = true;
  keep_corners(ring, 0, opposite, tolerance_m, kept);
  keep_corners(ring, opposite, ring.size(), tolerance_m, kept);
  UvRing result;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (kept[i]) result.push_back(ring[i]);
  }
  return result.size() < 3 ? UvRing{} : result;
}

polygon_t simplified(const polygon_t& polygon, float tolerance_m) {
  polygon_t result{};
  std::size_t at = 0;
  for (std::size_t r = 0; r < polygon.ring_size.size(); ++r) {
    UvRing ring;
    for (std::int32_t i = 0; i < polygon.ring_size[r]; ++i, at += 2)
      ring.emplace_back(polygon.uv_m[at], polygon.uv_m[at + 1]);
    ring = simplified(ring, tolerance_m);
    if (ring.empty() && r == 0) return polygon_t{};  // without its outer ring it is gone
    if (ring.empty()) continue;
    result.ring_size.push_back(static_cast<std::int32_t>(ring.size()));
    for (const auto& uv : ring) result.uv_m.insert(result.uv_m.end(), {uv.x(), uv.y()});
  }
  set_counts(result);
  return result;
}

/// Makes polygons coarser, and in the end fewer, until they take at most max_bytes. The largest, which comes first,
/// does not vanish by being coarser.
void simplify_to_fit(std::vector<polygon_t>& polygons, std::size_t max_bytes, double cell_size_m) {
  // Sixteen doublings of half a cell are kilometres; what is still too many pieces then loses the smallest, which come
  // last.
  auto tolerance_m = static_cast<float>(0.5 * cell_size_m);
  for (int step = 0; step < 16 && encoded_bytes(polygons) > max_bytes; ++step, tolerance_m *= 2.0F) {
    std::vector<polygon_t> coarse;
    coarse.reserve(polygons.size());
    for (const auto& polygon : polygons) {
      auto coarser = simplified(polygon, tolerance_m);
      if (coarser.n_rings > 0) coarse.push_back(std::move(coarser));
    }
    // Its largest piece stays, as it was, before a plane has no boundary at all.
    if (coarse.empty()) break;
    polygons = std::move(coarse);
  }
  while (!polygons.empty() && encoded_bytes(polygons) > max_bytes) polygons.pop_back();
}

}  // namespace

polygon_t to_wire(const Polygon& polygon) {
  polygon_t wire{};
  append_ring(polygon.outer, wire);
  for (const auto& hole : polygon.holes) append_ring(hole, wire);
  set_counts(wire);
  return wire;
}

plane_t to_wire(const PlaneRecord& record, const Outline& outline, PlaneClass plane_class) {
  plane_t wire{};
  wire.id = static_cast<std::int64_t>(record.id);
  copy(record.plane.normal(), wire.normal);
  wire.d = record.plane.d();
  double* entry = wire.covariance;
  for (Eigen::Index row = 0; row < 4; ++row) {
    for (Eigen::Index column = row; column < 4; ++column) *entry++ = record.covariance(row, column);
  }
  copy(record.centroid_m, wire.centroid_m);
  wire.area_m2 = outline.area_m2;
  wire.cell_count = to_count(record.cell_count);
  wire.point_count = static_cast<std::int64_t>(record.point_count);
  wire.first_seen_utime = record.first_seen_utime;
  wire.last_seen_utime = record.last_seen_utime;
  wire.plane_class = std::string(name_of(plane_class));
  wire.quality = record.quality;
  wire.revision = static_cast<std::int64_t>(record.revision);
  copy(outline.basis.origin_m, wire.origin_m);
  copy(outline.basis.axis_u, wire.axis_u);
  copy(outline.basis.axis_v, wire.axis_v);
  for (const auto& polygon : outline.polygons) wire.polygons.push_back(to_wire(polygon));
  wire.n_polygons = static_cast<std::int32_t>(wire.polygons.size());
  return wire;
}

planemap_lcm::cell_t to_wire(const CellView& cell) {
  planemap_lcm::cell_t wire{};
  copy(cell.centre_m, wire.centre_m);
  copy(cell.sigma_m, wire.sigma_m);
  copy(cell.normal.value_or(Eigen::Vector3d::Zero()), wire.normal);
  wire.deviation_rad = static_cast<float>(cell.deviation_rad);
  wire.count = to_count(cell.count);
  wire.plane_id = static_cast<std::int64_t>(cell.plane_id);
  return wire;
}

planemap_lcm::removed_plane_t to_wire(const RemovedPlane& removed) {
  planemap_lcm::removed_plane_t wire{};
  wire.id = static_cast<std::int64_t>(removed.id);
  wire.merged_into = static_cast<std::int64_t>(removed.merged_into);
  return wire;
}

bool simplify_to_fit(plane_t& plane, std::size_t max_bytes, double cell_size_m) {
  const std::size_t bytes = encoded_bytes(plane);
  if (bytes <= max_bytes) return false;
  const std::size_t head = bytes - encoded_bytes(plane.polygons);
  simplify_to_fit(plane.polygons, max_bytes - std::min(max_bytes, head), cell_size_m);
  plane.n_polygons = static_cast<std::int32_t>(plane.polygons.size());
  return true;
}

bool simplify_to_fit(planemap_lcm::region_plane_t& plane, std::size_t max_bytes, double cell_size_m) {
  const std::size_t bytes = encoded_bytes(plane);
  if (bytes <= max_bytes) return false;
  const std::size_t clipped = encoded_bytes(plane.clipped);
  const std::size_t head = bytes - clipped - encoded_bytes(plane.plane);
  const std::size_t room = max_bytes - std::min(max_bytes, head);
  simplify_to_fit(plane.plane, room - std::min(clipped, room / 2), cell_size_m);
  simplify_to_fit(plane.clipped, room - std::min(room, encoded_bytes(plane.plane)), cell_size_m);
  plane.n_clipped = static_cast<std::int32_t>(plane.clipped.size());
  return true;
}

bool simplify_to_fit(planemap_lcm::plan_polygon_t& polygon, std::size_t max_bytes, double cell_size_m) {
  const std::size_t bytes = encoded_bytes(polygon);
  if (bytes <= max_bytes) return false;
  const std::size_t head = bytes - encoded_bytes(polygon.polygon);
  std::vector<polygon_t> polygons = {polygon.polygon};
  simplify_to_fit(polygons, max_bytes - std::min(max_bytes, head), cell_size_m);
  if (!polygons.empty()) polygon.polygon = std::move(polygons.front());
  return true;
}

}  // namespace planemap::service

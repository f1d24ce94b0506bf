#include "reply_codec.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>

#include "wire_cursor.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::cell_t;
using planemap_lcm::plane_t;
using planemap_lcm::polygon_t;
using planemap_lcm::reply_t;
using planemap_lcm::status_t;

// Bytes of the fixed parts of the wire types, member by member as in lcmtypes/planemap_lcm.
constexpr std::size_t kCellBytes = 10 * 4 + 4 + 8;
constexpr std::size_t kPlaneHeadBytes = 8 + 3 * 8 + 8 + 10 * 8 + 3 * 8 + 8 + 4 + 3 * 8;  // up to plane_class
constexpr std::size_t kPlaneTailBytes = 2 * 8 + 3 * 3 * 8;                               // from quality to n_polygons
constexpr std::size_t kStringLeastBytes = 4 + 1;
constexpr std::size_t kPolygonLeastBytes = 4 + 4;
constexpr std::size_t kPlaneLeastBytes = kPlaneHeadBytes + kStringLeastBytes + kPlaneTailBytes + 4;
constexpr std::size_t kCounterLeastBytes = kStringLeastBytes + 8;
constexpr std::size_t kStatusLeastBytes = 8 + 5 * 8 + 3 * 8 + 8 + 2 * kStringLeastBytes + 4;
constexpr std::size_t kReplyHeadBytes = 5 * 8 + 2 * 4 + 1;  // fingerprint to status
constexpr int kMaxPages = 1'000'000;                        // 60 GB

void walk_plane(WireCursor& cursor) {
  cursor.skip(kPlaneHeadBytes);
  cursor.string();
  cursor.skip(kPlaneTailBytes);
  const std::size_t polygons = cursor.count(kPolygonLeastBytes);
  for (std::size_t i = 0; i < polygons && cursor.ok(); ++i) {
    cursor.skip(4 * cursor.count(4));
    cursor.skip(4 * cursor.count(4));
  }
}

void walk_status(WireCursor& cursor) {
  cursor.skip(8);
  cursor.string();
  cursor.skip(5 * 8 + 3 * 8 + 8);
  cursor.string();
  const std::size_t counters = cursor.count(kCounterLeastBytes);
  for (std::size_t i = 0; i < counters && cursor.ok(); ++i) {
    cursor.string();
    cursor.skip(8);
  }
}

/// Whether the counts of a reply_t agree with its size: generated decoders take memory for a count before they look.
bool counts_agree(std::span<const std::uint8_t> bytes) {
  WireCursor cursor(bytes);
  cursor.skip(kReplyHeadBytes);
  cursor.string();
  cursor.string();
  const std::size_t planes = cursor.count(kPlaneLeastBytes);
  for (std::size_t i = 0; i < planes && cursor.ok(); ++i) walk_plane(cursor);
  cursor.skip(kCellBytes * cursor.count(kCellBytes));
  const std::size_t statuses = cursor.count(kStatusLeastBytes);
  for (std::size_t i = 0; i < statuses && cursor.ok(); ++i) walk_status(cursor);
  return cursor.ok() && cursor.remaining() == 0;
}

template <class Numbers>
bool all_finite(const Numbers& numbers) {
  return std::all_of(std::begin(numbers), std::end(numbers), [](auto number) { return std::isfinite(number); });
}

bool rings_agree(const polygon_t& polygon) {
  std::int64_t vertices = 0;
  for (const std::int32_t size : polygon.ring_size) {
    if (size < 3) return false;
    vertices += size;
  }
  return polygon.n_rings >= 1 && 2 * vertices == polygon.n_values && all_finite(polygon.uv_m);
}

bool is_sound(const plane_t& plane) {
  return all_finite(plane.normal) && std::isfinite(plane.d) && all_finite(plane.covariance) &&
         all_finite(plane.centroid_m) && std::isfinite(plane.area_m2) && all_finite(plane.origin_m) &&
         all_finite(plane.axis_u) && all_finite(plane.axis_v) &&
         std::all_of(plane.polygons.begin(), plane.polygons.end(), rings_agree);
}

bool is_sound(const cell_t& cell) {
  return all_finite(cell.centre_m) && all_finite(cell.sigma_m) && all_finite(cell.normal) && cell.count >= 0;
}

Vector3 vector3_of(const double (&values)[3]) {
  return {values[0], values[1], values[2]};
}
Vector3 vector3_of(const float (&values)[3]) {
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
  cell.centre_m = vector3_of(wire.centre_m);
  cell.sigma_m = vector3_of(wire.sigma_m);
  cell.normal = vector3_of(wire.normal);
  cell.deviation_rad = wire.deviation_rad;
  cell.count = wire.count;
  cell.plane_id = wire.plane_id;
  return cell;
}

}  // namespace

tl::expected<reply_t, std::string> decode_reply(std::span<const std::uint8_t> bytes) {
  const auto wrong = [](const char* what) { return tl::make_unexpected(std::string("reply_t: ") + what); };
  if (WireCursor(bytes).int64() != reply_t::getHash()) return wrong("another type's fingerprint");
  if (!counts_agree(bytes)) return wrong("its counts do not agree with its size");
  reply_t reply;
  try {
    const int size = static_cast<int>(bytes.size());
    if (reply.decode(bytes.data(), 0, size) != size) return wrong("not every byte could be read");
  } catch (const std::exception&) {
    return wrong("it can't be decoded");
  }
  if (reply.page_count < 1 || reply.page_count > kMaxPages || reply.page < 0 || reply.page >= reply.page_count) {
    return wrong("its page number is beyond its page count");
  }
  if (reply.n_status > 1) return wrong("it holds more than one status");
  const auto sound = [](const auto& element) { return is_sound(element); };
  if (!std::all_of(reply.planes.begin(), reply.planes.end(), sound)) return wrong("a plane's numbers are not sound");
  if (!std::all_of(reply.cells.begin(), reply.cells.end(), sound)) return wrong("a cell's numbers are not sound");
  return reply;
}

Map map_of(const std::vector<reply_t>& pages) {
  Map map;
  if (pages.empty()) return map;
  map.frame = pages.front().frame;
  map.epoch = pages.front().epoch;
  map.revision = pages.front().revision;
  for (const reply_t& page : pages) {
    std::transform(page.planes.begin(), page.planes.end(), std::back_inserter(map.planes), plane_of);
    std::transform(page.cells.begin(), page.cells.end(), std::back_inserter(map.cells), cell_of);
  }
  std::stable_sort(map.planes.begin(), map.planes.end(), [](const Plane& a, const Plane& b) { return a.id < b.id; });
  return map;
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
  for (const auto& counter : wire.counters) status.counters[counter.name] = counter.value;
  return status;
}

}  // namespace planemap::client

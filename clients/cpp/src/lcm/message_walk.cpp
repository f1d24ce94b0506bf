#include <cstddef>

#include "lcm/message_checks.hpp"
#include "lcm/wire_cursor.hpp"

namespace planemap::client {
namespace {

// Bytes of the fixed parts of the wire types, member by member as in lcmtypes/planemap_lcm.
constexpr std::size_t kCellBytes = 10 * 4 + 4 + 8;
constexpr std::size_t kPlaneHeadBytes = 8 + 3 * 8 + 8 + 10 * 8 + 3 * 8 + 8 + 4 + 3 * 8;  // up to plane_class
constexpr std::size_t kPlaneTailBytes = 2 * 8 + 3 * 3 * 8;                               // from quality to n_polygons
constexpr std::size_t kStringLeastBytes = 4 + 1;
constexpr std::size_t kPolygonLeastBytes = 4 + 4;
constexpr std::size_t kPlaneLeastBytes = kPlaneHeadBytes + kStringLeastBytes + kPlaneTailBytes + 4;
constexpr std::size_t kCounterLeastBytes = kStringLeastBytes + 8;
constexpr std::size_t kStatusLeastBytes = 8 + 5 * 8 + 3 * 8 + 8 + 3 * kStringLeastBytes + 4;
constexpr std::size_t kReplyHeadBytes = 5 * 8 + 2 * 4 + 1;  // fingerprint to status

constexpr std::size_t kNearPlaneBytes = 4 + 8 + 4 * 8 + 3 * 8 + 3 * 8 + 1;
constexpr std::size_t kPlaneHitBytes = 4 + 8 + 3 * 8 + 1 + 3 * 8;
constexpr std::size_t kCellHitBytes = 4 + kCellBytes + 4 * 8;
constexpr std::size_t kRegionPlaneLeastBytes = kPlaneLeastBytes + 1 + 8 + 4;
constexpr std::size_t kLookupLeastBytes = 8 + 1 + 8 + 8 + 3 * 4;
constexpr std::size_t kFloorplanBytes = 3 * 3 * 8 + 2 * 8;
constexpr std::size_t kPlanPolygonLeastBytes = 1 + kPolygonLeastBytes;
constexpr std::size_t kRemovedBytes = 2 * 8;
constexpr std::size_t kDeltaHeadBytes = 5 * 8 + 2 * 4;  // fingerprint to page_count

/// A list of items of one size.
void walk_items(WireCursor& cursor, std::size_t item_bytes) {
  cursor.skip(item_bytes * cursor.count(item_bytes));
}

/// A list of items of different sizes.
template <class WalkItem>
void walk_list(WireCursor& cursor, std::size_t least_item_bytes, const WalkItem& walk_item) {
  const std::size_t count = cursor.count(least_item_bytes);
  for (std::size_t i = 0; i < count && cursor.ok(); ++i) walk_item(cursor);
}

void walk_polygon(WireCursor& cursor) {
  walk_items(cursor, 4);
  walk_items(cursor, 4);
}

void walk_plane(WireCursor& cursor) {
  cursor.skip(kPlaneHeadBytes);
  cursor.string();
  cursor.skip(kPlaneTailBytes);
  walk_list(cursor, kPolygonLeastBytes, walk_polygon);
}

void walk_status(WireCursor& cursor) {
  cursor.skip(8);
  cursor.string();
  cursor.skip(5 * 8 + 3 * 8 + 8);
  cursor.string();  // idle_reason
  cursor.string();  // degraded
  walk_list(cursor, kCounterLeastBytes, [](WireCursor& counter) {
    counter.string();
    counter.skip(8);
  });
}

void walk_region_plane(WireCursor& cursor) {
  walk_plane(cursor);
  cursor.skip(1 + 8);
  walk_list(cursor, kPolygonLeastBytes, walk_polygon);
}

void walk_lookup(WireCursor& cursor) {
  cursor.skip(8 + 1 + 8 + 8);
  for (int list = 0; list < 3; ++list) walk_items(cursor, 8);
}

void walk_plan_polygon(WireCursor& cursor) {
  cursor.skip(1);
  walk_polygon(cursor);
}

}  // namespace

bool reply_counts_agree(std::span<const std::uint8_t> bytes) {
  WireCursor cursor(bytes);
  cursor.skip(kReplyHeadBytes);
  cursor.string();
  cursor.string();
  walk_list(cursor, kPlaneLeastBytes, walk_plane);
  walk_items(cursor, kCellBytes);
  walk_list(cursor, kStatusLeastBytes, walk_status);
  walk_items(cursor, kNearPlaneBytes);
  walk_items(cursor, kPlaneHitBytes);
  walk_items(cursor, kCellHitBytes);
  walk_list(cursor, kRegionPlaneLeastBytes, walk_region_plane);
  walk_list(cursor, kLookupLeastBytes, walk_lookup);
  walk_items(cursor, kFloorplanBytes);
  walk_list(cursor, kPlanPolygonLeastBytes, walk_plan_polygon);
  return cursor.ok() && cursor.remaining() == 0;
}

bool delta_counts_agree(std::span<const std::uint8_t> bytes) {
  WireCursor cursor(bytes);
  cursor.skip(kDeltaHeadBytes);
  cursor.string();
  walk_list(cursor, kPlaneLeastBytes, walk_plane);
  walk_items(cursor, kRemovedBytes);
  return cursor.ok() && cursor.remaining() == 0;
}

}  // namespace planemap::client

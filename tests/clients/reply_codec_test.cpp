#include "lcm/reply_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "fake_map_service.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::reply_t;
using Bytes = std::vector<std::uint8_t>;

/// A reply with something in every array.
reply_t full_reply() {
  reply_t reply{};
  reply.page_count = 1;
  reply.frame = "world";
  reply.planes = {wire_plane(1), wire_plane(2)};
  reply.n_planes = 2;
  planemap_lcm::cell_t cell{};
  cell.centre_m[1] = 2.5F;
  cell.count = 17;
  cell.plane_id = 2;
  reply.cells = {cell, cell, cell};
  reply.n_cells = 3;
  planemap_lcm::status_t status{};
  status.version = "v";
  planemap_lcm::counter_t counter{};
  counter.name = "poses.received";
  counter.value = 3;
  status.counters = {counter, counter};
  status.n_counters = 2;
  reply.service_status = {status};
  reply.n_status = 1;
  reply.near_planes.resize(2);
  reply.plane_hits.resize(2);
  reply.cell_hits.resize(1);
  for (auto& near : reply.near_planes) near.plane_id = 1;
  for (auto& hit : reply.plane_hits) hit.plane_id = 2;
  planemap_lcm::region_plane_t in_region{};
  in_region.plane = wire_plane(3);
  in_region.clipped = in_region.plane.polygons;
  in_region.n_clipped = 1;
  reply.region_planes = {in_region};
  planemap_lcm::plane_lookup_t lookup{};
  lookup.fate = planemap_lcm::plane_lookup_t::FATE_LIVES;
  lookup.lineage = {1};
  lookup.coplanar = {2, 3};
  lookup.merged = {4};
  lookup.n_lineage = lookup.n_merged = 1;
  lookup.n_coplanar = 2;
  reply.lookups = {lookup};
  reply.floorplans.resize(1);
  planemap_lcm::plan_polygon_t polygon{};
  polygon.kind = planemap_lcm::plan_polygon_t::KIND_WALL;
  polygon.polygon = in_region.clipped[0];
  reply.plan_polygons = {polygon, polygon};
  reply.n_near_planes = reply.n_plane_hits = reply.n_plan_polygons = 2;
  reply.n_cell_hits = reply.n_region_planes = reply.n_lookups = reply.n_floorplans = 1;
  return reply;
}

planemap_lcm::planes_t full_delta() {
  planemap_lcm::planes_t delta{};
  delta.epoch = 7;
  delta.since_revision = 3;
  delta.revision = 5;
  delta.page_count = 1;
  delta.frame = "world";
  delta.planes = {wire_plane(1), wire_plane(2)};
  delta.n_planes = 2;
  delta.removed.resize(3);
  delta.n_removed = 3;
  return delta;
}

template <class Message>
Bytes encoded(const Message& reply) {
  Bytes bytes(static_cast<std::size_t>(reply.getEncodedSize()));
  EXPECT_EQ(reply.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return bytes;
}

TEST(DecodeReply, ReadsBackWhatWasEncoded) {
  const Bytes bytes = encoded(full_reply());
  const auto reply = decode_reply(bytes);
  ASSERT_TRUE(reply) << reply.error();
  EXPECT_EQ(encoded(*reply), bytes);
}

TEST(DecodeReply, EveryTruncationFails) {
  const Bytes bytes = encoded(full_reply());
  ASSERT_GT(bytes.size(), 500u);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_reply(std::span(bytes).first(size))) << size << " bytes";
  }
}

TEST(DecodeReply, TrailingBytesFail) {
  Bytes bytes = encoded(full_reply());
  bytes.push_back(0);
  EXPECT_FALSE(decode_reply(bytes));
}

/// Each four bytes of a good message in turn replaced by a count that would take gigabytes, or a negative one: that
/// must neither throw nor take memory for it.
TEST(DecodeReply, CountsThatDoNotFitTakeNoMemory) {
  const Bytes good = encoded(full_reply());
  const std::array<std::array<std::uint8_t, 4>, 3> bombs = {
      {{0x7f, 0xff, 0xff, 0xff}, {0xff, 0xff, 0xff, 0xff}, {0x00, 0xff, 0xff, 0xff}}};
  std::size_t refused = 0;
  for (const auto& bomb : bombs) {
    for (std::size_t at = 8; at + 4 <= good.size(); ++at) {
      Bytes bytes = good;
      std::copy(bomb.begin(), bomb.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
      const auto reply = decode_reply(bytes);
      if (!reply) {
        ++refused;
        continue;
      }
      EXPECT_LE(reply->planes.size() + reply->cells.size() + reply->near_planes.size(), 7u);
    }
  }
  EXPECT_GT(refused, 3u * 40u);
}

TEST(DecodeReply, RandomFlipsNeverGetThroughBroken) {
  const Bytes good = encoded(full_reply());
  std::mt19937 random(1);
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes = good;
    for (int flip = 0; flip < 3; ++flip)
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << (random() % 8));
    const auto reply = decode_reply(bytes);
    if (!reply) continue;
    const Map map = map_of({*reply});  // must not read beyond any ring
    for (const Plane& plane : map.planes) EXPECT_TRUE(std::isfinite(plane.d));
  }
}

TEST(DecodeReply, NumbersThatMakeNoSenseFail) {
  const auto fails_when = [](const std::function<void(reply_t&)>& spoil) {
    reply_t reply = full_reply();
    spoil(reply);
    return !decode_reply(encoded(reply)).has_value();
  };
  EXPECT_FALSE(fails_when([](reply_t&) {}));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.page = 1; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.page = -1; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.page_count = 0; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.page_count = std::numeric_limits<std::int32_t>::max(); }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.planes[1].d = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.planes[0].polygons[0].ring_size = {4, 5}; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.planes[0].polygons[0].ring_size = {9, -1}; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.planes[0].polygons[0].ring_size = {6, 2}; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.cells[2].centre_m[0] = std::numeric_limits<float>::infinity(); }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.cells[0].count = -1; }));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(fails_when([](reply_t& r) { r.planes[0].id = 0; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.near_planes[1].point = -1; }));
  EXPECT_TRUE(fails_when([&](reply_t& r) { r.near_planes[0].sigma_m = nan; }));
  EXPECT_TRUE(fails_when([&](reply_t& r) { r.near_planes[0].mahalanobis = nan; }));
  EXPECT_FALSE(fails_when([](reply_t& r) { r.near_planes[0].mahalanobis = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.plane_hits[0].ray = -1; }));
  EXPECT_TRUE(fails_when([&](reply_t& r) { r.cell_hits[0].range_m = nan; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.region_planes[0].clipped[0].ring_size = {8}; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.lookups[0].fate = 9; }));
  EXPECT_TRUE(fails_when([&](reply_t& r) { r.floorplans[0].up[1] = nan; }));
  EXPECT_TRUE(fails_when([](reply_t& r) { r.plan_polygons[0].kind = 0; }));
}

TEST(DecodeDelta, ReadsBackWhatWasEncodedAndNothingShorterOrLonger) {
  Bytes bytes = encoded(full_delta());
  const auto delta = decode_delta(bytes);
  ASSERT_TRUE(delta) << delta.error();
  EXPECT_EQ(encoded(*delta), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_delta(std::span(bytes).first(size))) << size << " bytes";
  }
  bytes.push_back(0);
  EXPECT_EQ(decode_delta(bytes).error(), "planes_t: its counts do not agree with its size");
  EXPECT_EQ(decode_delta(encoded(full_reply())).error(), "planes_t: another type's fingerprint");
}

TEST(DecodeDelta, RandomFlipsNeverGetThroughBroken) {
  const Bytes good = encoded(full_delta());
  std::mt19937 random(2);
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes = good;
    for (int flip = 0; flip < 3; ++flip)
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << (random() % 8));
    const auto delta = decode_delta(bytes);
    if (!delta) continue;
    EXPECT_LE(delta->planes.size() + delta->removed.size(), 5u);
    EXPECT_LE(delta->since_revision, delta->revision);
    EXPECT_LT(delta->page, delta->page_count);
  }
}

TEST(DecodeDelta, NumbersThatMakeNoSenseFail) {
  auto delta = full_delta();
  delta.since_revision = 6;
  EXPECT_EQ(decode_delta(encoded(delta)).error(), "planes_t: it goes back in revisions");
  delta = full_delta();
  delta.page = 1;
  EXPECT_EQ(decode_delta(encoded(delta)).error(), "planes_t: its page number is beyond its page count");
  delta = full_delta();
  delta.planes[1].normal[0] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(decode_delta(encoded(delta)).error(), "planes_t: a plane's numbers are not sound");
}

TEST(DecodeStatusVersion, IsReadOrSaidToEndEarly) {
  planemap_lcm::status_t status{};
  status.version = "1";
  status.epoch = 8;
  status.revision = 9;
  const Bytes bytes = encoded(status);
  const auto version = decode_status_version(bytes);
  ASSERT_TRUE(version) << version.error();
  EXPECT_EQ(version->epoch, 8);
  EXPECT_EQ(version->revision, 9);
  EXPECT_EQ(decode_status_version(std::span(bytes).first(30)).error(), "status_t: it ends early");
  EXPECT_EQ(decode_status_version(encoded(full_delta())).error(), "status_t: another type's fingerprint");
}

}  // namespace
}  // namespace planemap::client

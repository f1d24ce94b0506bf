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
  return reply;
}

Bytes encoded(const reply_t& reply) {
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
      EXPECT_LE(reply->planes.size() + reply->cells.size(), 5u);
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
}

}  // namespace
}  // namespace planemap::client

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/reply_t.hpp>

#include "codec/page_codec.hpp"
#include "codec/plane_codec.hpp"
#include "codec/request_codec.hpp"
#include "lcm/walls.hpp"
#include "serve/lcm/delta_maker.hpp"
#include "serve/lcm/outbox.hpp"
#include "serve/plane_book.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::plane_t;
using planemap_lcm::planes_t;
using planemap_lcm::reply_t;

/// A plane whose boundary is a circle with many corners.
plane_t round_plane(int corners) {
  plane_t plane{};
  plane.id = 4;
  planemap_lcm::polygon_t polygon{};
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    polygon.uv_m.push_back(static_cast<float>(30.0 * std::cos(angle)));
    polygon.uv_m.push_back(static_cast<float>(30.0 * std::sin(angle)));
  }
  polygon.ring_size = {corners};
  polygon.n_rings = 1;
  polygon.n_values = 2 * corners;
  plane.polygons = {polygon};
  plane.n_polygons = 1;
  return plane;
}

double area_of(const planemap_lcm::polygon_t& polygon) {
  double twice = 0.0;
  const auto n = static_cast<std::size_t>(polygon.ring_size.at(0));
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    twice += static_cast<double>(polygon.uv_m[2 * i]) * polygon.uv_m[2 * j + 1] -
             static_cast<double>(polygon.uv_m[2 * j]) * polygon.uv_m[2 * i + 1];
  }
  return twice / 2.0;
}

TEST(PlaneCodec, CarriesEveryFieldOfARecord) {
  PlaneRecord record;
  record.id = 12;
  record.plane = Plane::through({0.0, 0.0, 2.0}, {0.0, 0.0, -1.0});
  for (int i = 0; i < 16; ++i) record.covariance(i / 4, i % 4) = (i / 4 + 1) * (i % 4 + 1);
  record.centroid_m = {0.5, 0.25, 2.0};
  record.cell_count = 40;
  record.point_count = 5000000000;
  record.first_seen_utime = 1;
  record.last_seen_utime = 2;
  record.quality = 0.75;
  record.revision = 6;
  Outline outline{basis_of(record.plane, record.centroid_m), {}, 3.5};
  outline.polygons.push_back({{{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {{{0.5, 0.5}, {0.5, 1}, {1, 1}}}});
  const plane_t wire = to_wire(record, outline, PlaneClass::kWall);
  EXPECT_EQ(wire.id, 12);
  EXPECT_EQ(wire.normal[2], -1.0);
  EXPECT_EQ(wire.d, 2.0);
  const double upper[] = {1, 2, 3, 4, 4, 6, 8, 9, 12, 16};
  for (int i = 0; i < 10; ++i) EXPECT_EQ(wire.covariance[i], upper[i]) << i;
  EXPECT_EQ(wire.centroid_m[1], 0.25);
  EXPECT_EQ(wire.area_m2, 3.5);
  EXPECT_EQ(wire.cell_count, 40);
  EXPECT_EQ(wire.point_count, 5000000000);
  EXPECT_EQ(wire.plane_class, "wall");
  EXPECT_EQ(wire.quality, 0.75);
  EXPECT_EQ(wire.revision, 6);
  ASSERT_EQ(wire.n_polygons, 1);
  EXPECT_EQ(wire.polygons[0].ring_size, (std::vector<std::int32_t>{4, 3}));
  EXPECT_EQ(wire.polygons[0].n_values, 14);
  EXPECT_EQ(wire.polygons[0].uv_m[2], 2.0F);
  const Eigen::Vector3d u(wire.axis_u[0], wire.axis_u[1], wire.axis_u[2]);
  const Eigen::Vector3d v(wire.axis_v[0], wire.axis_v[1], wire.axis_v[2]);
  EXPECT_NEAR((u.cross(v) - record.plane.normal()).norm(), 0.0, 1e-12);
  EXPECT_EQ(encoded(wire).size(), static_cast<std::size_t>(wire.getEncodedSize()));
}

TEST(PlaneCodec, CoarserBoundaryFitsAndKeepsItsShape) {
  plane_t plane = round_plane(20000);  // 160 kB
  EXPECT_TRUE(simplify_to_fit(plane, 20000, 0.08));
  EXPECT_LE(plane.getEncodedSize(), 20008);
  ASSERT_EQ(plane.n_polygons, 1);
  EXPECT_NEAR(area_of(plane.polygons[0]), std::numbers::pi * 900.0, 5.0);
  EXPECT_FALSE(simplify_to_fit(plane, 20000, 0.08)) << "what fits stays";
}

TEST(PlaneCodec, ManyPiecesLoseTheSmallest) {
  plane_t plane{};
  for (int i = 0; i < 5000; ++i) {
    const float edge_m = i == 0 ? 50.0F : 0.1F;
    planemap_lcm::polygon_t square{};
    square.uv_m = {0, 0, edge_m, 0, edge_m, edge_m, 0, edge_m};
    square.ring_size = {4};
    square.n_rings = 1;
    square.n_values = 8;
    plane.polygons.push_back(square);
  }
  plane.n_polygons = 5000;
  EXPECT_TRUE(simplify_to_fit(plane, 4000, 0.08));
  EXPECT_LE(plane.getEncodedSize(), 4008);
  ASSERT_GE(plane.n_polygons, 1);
  EXPECT_NEAR(area_of(plane.polygons[0]), 2500.0, 1e-3);
}

TEST(PageCodec, EveryPageIsAWholeMessageWithinTheLimit) {
  planes_t header{};
  header.epoch = 3;
  header.since_revision = 4;
  header.revision = 5;
  header.frame = "world";
  std::vector<plane_t> planes;
  for (int i = 0; i < 40; ++i) {
    planes.push_back(round_plane(100));
    planes.back().id = i + 1;
  }
  planes[7] = round_plane(20000);
  planes[7].id = 8;
  std::vector<planemap_lcm::removed_plane_t> removed(2000);
  for (int i = 0; i < 2000; ++i) removed[static_cast<std::size_t>(i)].id = 1000 + i;
  const Pages pages = encode_pages(header, planes, removed, 8192, 0.08);
  ASSERT_GT(pages.size(), 5u);
  std::int64_t next_plane = 1;
  std::int64_t next_removed = 1000;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    EXPECT_LE(pages[i].size(), 8192u);
    const auto message = decoded<planes_t>({pages[i]})[0];
    EXPECT_EQ(message.page, static_cast<std::int32_t>(i));
    EXPECT_EQ(message.page_count, static_cast<std::int32_t>(pages.size()));
    EXPECT_EQ(message.epoch, 3);
    EXPECT_EQ(message.revision, 5);
    EXPECT_EQ(message.frame, "world");
    for (const auto& plane : message.planes) EXPECT_EQ(plane.id, next_plane++);
    for (const auto& plane : message.removed) EXPECT_EQ(plane.id, next_removed++);
  }
  EXPECT_EQ(next_plane, 41);
  EXPECT_EQ(next_removed, 3000);
  EXPECT_EQ(encode_pages(header, {}, {}, 8192, 0.08).size(), 1u);
}

TEST(PageCodec, RestampedReplyDiffersOnlyInItsStamp) {
  reply_t reply{};
  reply.utime = 1;
  reply.request_id = 2;
  reply.revision = 3;
  reply.frame = "world";
  Page page = encode(reply);
  restamp_reply(page, 0x1122334455667788, -5);
  const auto stamped = decoded<reply_t>({page})[0];
  EXPECT_EQ(stamped.utime, 0x1122334455667788);
  EXPECT_EQ(stamped.request_id, -5);
  EXPECT_EQ(stamped.revision, 3);
  EXPECT_EQ(stamped.frame, "world");
}

TEST(DeltaMaker, TellsWhatChangedAndNothingTwice) {
  Walls walls;
  PlaneBook book(MapConfig{});
  DeltaMaker maker(ServiceConfig{}, book);
  walls.look_at(1000);
  auto delta = decoded<planes_t>(maker.make(walls.snapshot()));
  ASSERT_EQ(delta.size(), 1u);
  EXPECT_EQ(delta[0].since_revision, 0);
  ASSERT_EQ(delta[0].n_planes, 1);
  EXPECT_EQ(delta[0].planes[0].plane_class, "other");
  EXPECT_NEAR(delta[0].planes[0].area_m2, 1.07 * 0.8, 0.15);
  EXPECT_TRUE(maker.make(walls.snapshot()).empty());
  const std::int64_t first = delta[0].revision;
  const std::int64_t first_id = delta[0].planes[0].id;
  walls.look_at(750, std::numbers::pi / 2);
  delta = decoded<planes_t>(maker.make(walls.snapshot()));
  ASSERT_EQ(delta.size(), 1u);
  EXPECT_EQ(delta[0].since_revision, first);
  ASSERT_EQ(delta[0].n_planes, 1) << "the first wall did not change";
  EXPECT_NE(delta[0].planes[0].id, first_id);
}

TEST(DeltaMaker, ANewEpochIsToldFromItsBeginning) {
  PlaneBook book(MapConfig{});
  DeltaMaker maker(ServiceConfig{}, book);
  Walls first(1);
  first.look_at(1000);
  first.look_at(750, std::numbers::pi / 2);
  maker.make(first.snapshot());
  Walls second(2);
  second.look_at(1100);
  const auto delta = decoded<planes_t>(maker.make(second.snapshot()));
  ASSERT_EQ(delta.size(), 1u);
  EXPECT_EQ(delta[0].epoch, 2);
  EXPECT_EQ(delta[0].since_revision, 0);
  EXPECT_EQ(delta[0].n_planes, 1);
}

TEST(PlaneBook, KnowsClassesWhereGravityIsKnown) {
  MapConfig config;
  config.gravity = {0.0, 1.0, 0.0};  // the camera's y is down: it looks at a wall
  PlaneBook book(config);
  Walls walls;
  walls.look_at(1000);
  const auto snapshot = walls.snapshot();
  const auto queries = book.open(snapshot);
  const auto planes = queries->planes();
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_EQ(planes[0].plane_class, PlaneClass::kWall);
}

TEST(PlaneBook, MakesABoundaryAnewOnlyForAChangedPlane) {
  PlaneBook book(MapConfig{});
  Walls walls;
  walls.look_at(1000);
  const auto outline = book.open(walls.snapshot())->planes()[0].outline;
  walls.look_at(750, std::numbers::pi / 2);
  const auto queries = book.open(walls.snapshot());
  const auto planes = queries->planes();
  ASSERT_EQ(planes.size(), 2u);
  EXPECT_EQ(planes[0].outline, outline);
  EXPECT_NE(planes[1].outline, outline);
}

TEST(PageCodec, AnItemThatFitsNoPageIsSaid) {
  reply_t answer{};
  planemap_lcm::plane_lookup_t lookup{};
  lookup.lineage.resize(1000, 5);
  lookup.n_lineage = 1000;
  answer.lookups = {lookup};
  const auto pages = encode_pages(answer, 4096, 0.08);
  ASSERT_FALSE(pages);
  EXPECT_EQ(pages.error().message, "the plane's lineage and links does not fit on a page (publish.page_bytes)");
  EXPECT_TRUE(encode_pages(answer, 60000, 0.08));
}

TEST(PageCodec, RegionsAndPlansAreMadeCoarserToFit) {
  reply_t answer{};
  planemap_lcm::region_plane_t plane{};
  plane.plane = round_plane(20000);
  plane.clipped = plane.plane.polygons;
  plane.n_clipped = 1;
  answer.region_planes = {plane};
  planemap_lcm::plan_polygon_t polygon{};
  polygon.kind = planemap_lcm::plan_polygon_t::KIND_FLOOR;
  polygon.polygon = plane.clipped[0];
  answer.plan_polygons = {polygon};
  const auto pages = encode_pages(answer, 8192, 0.08);
  ASSERT_TRUE(pages) << pages.error().message;
  int planes = 0;
  int polygons = 0;
  for (const auto& page : *pages) EXPECT_LE(page.size(), 8192u);
  for (const auto& page : decoded<reply_t>(*pages)) {
    for (const auto& found : page.region_planes) {
      ++planes;
      ASSERT_EQ(found.n_clipped, 1);
      EXPECT_NEAR(area_of(found.clipped[0]), std::numbers::pi * 900.0, 20.0);
      ASSERT_EQ(found.plane.n_polygons, 1);
      EXPECT_NEAR(area_of(found.plane.polygons[0]), std::numbers::pi * 900.0, 20.0);
    }
    for (const auto& found : page.plan_polygons) {
      ++polygons;
      EXPECT_NEAR(area_of(found.polygon), std::numbers::pi * 900.0, 20.0);
    }
  }
  EXPECT_EQ(planes, 1);
  EXPECT_EQ(polygons, 1);
}

TEST(RequestCodec, TakesOnlyReplyChannelsOfItsKind) {
  const auto reason_of = [](const std::string& channel) {
    auto message = request_message(1);
    message.reply_channel = channel;
    const auto request = decode_request(encoded(message));
    return request ? "accepted" : request.error().reason;
  };
  EXPECT_EQ(reason_of("PLANEMAP_REPLY"), "accepted");
  EXPECT_EQ(reason_of("PLANEMAP_REPLY_" + std::string(48, 'x')), "accepted");  // 63 characters
  EXPECT_EQ(reason_of("PLANEMAP_REPLY_" + std::string(49, 'x')), "reply_channel");
  EXPECT_EQ(reason_of("PLANEMAP_SCAN"), "reply_channel");
  EXPECT_EQ(reason_of(""), "reply_channel");
  EXPECT_EQ(reason_of("PLANEMAP_REPLY\n"), "reply_channel");
  auto bytes = encoded(request_message(1));
  bytes.push_back(0);
  EXPECT_EQ(decode_request(bytes).error().reason, "size");
}

TEST(Outbox, SendsPagesInOrderWithPauses) {
  Outbox outbox(0.5);
  reply_t reply{};
  outbox.add(Reply{"PLANEMAP_REPLY", 42, std::make_shared<const Pages>(Pages{encode(reply), encode(reply)}), 0, 2, {}});
  outbox.add("DELTA", Pages{Page{1}});
  outbox.add("NOTHING", Pages{});
  ASSERT_EQ(outbox.jobs(), 2u);
  const auto first = outbox.take(10.0, 77);
  EXPECT_EQ(first.channel, "PLANEMAP_REPLY");
  const auto stamped = decoded<reply_t>({first.bytes})[0];
  EXPECT_EQ(stamped.request_id, 42);
  EXPECT_EQ(stamped.utime, 77);
  EXPECT_EQ(outbox.due_s(), 10.5);
  EXPECT_EQ(outbox.take(10.5, 77).channel, "PLANEMAP_REPLY");
  const auto last = outbox.take(11.0, 77);
  EXPECT_EQ(last.channel, "DELTA");
  EXPECT_EQ(last.bytes, Page{1});
  EXPECT_TRUE(outbox.empty());
}

}  // namespace
}  // namespace planemap::service

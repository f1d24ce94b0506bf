#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <planemap/mapper.hpp>
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <stdexcept>

#include "codec/page_codec.hpp"
#include "codec/plane_codec.hpp"
#include "codec/request_codec.hpp"
#include "serve/lcm/delta_maker.hpp"
#include "serve/lcm/outbox.hpp"
#include "serve/lcm/request_answerer.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::plane_t;
using planemap_lcm::planes_t;
using planemap_lcm::reply_t;
using planemap_lcm::request_t;

template <class Message>
std::vector<Message> decoded(const Pages& pages) {
  std::vector<Message> messages;
  for (const auto& page : pages) {
    Message message{};
    const int size = static_cast<int>(page.size());
    EXPECT_EQ(message.decode(page.data(), 0, size), size);
    messages.push_back(std::move(message));
  }
  return messages;
}

/// A mapper that looks at walls; snapshots come from it.
class Walls {
 public:
  explicit Walls(std::uint64_t epoch = 9) : mapper_(preset(Preset::kBest), epoch) {}
  void look_at(std::uint16_t depth_mm, double yaw_rad = 0.0) {
    DepthScan scan;
    scan.utime = ++utime_;
    scan.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
    scan.depth.assign(80 * 60, depth_mm);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
    mapper_.integrate(scan, T);
  }
  std::shared_ptr<const MapSnapshot> snapshot() { return mapper_.snapshot(); }

 private:
  Mapper mapper_;
  std::int64_t utime_ = 1000000;
};

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

class RequestAnswererTest : public testing::Test {
 protected:
  RequestAnswererTest() : book_(config_.map), answerer_(make_config(), book_) { walls_.look_at(1000); }

  static ServiceConfig make_config() {
    ServiceConfig config;
    config.publish.page_bytes = 4096;
    config.publish.kept_replies = 2;
    return config;
  }
  Reply ask(Request request, std::shared_ptr<const MapSnapshot> snapshot) {
    return answerer_.answer(
        request, snapshot, [] { return planemap_lcm::status_t{}; }, 123);
  }
  static Request request_for(std::int16_t operation, const std::string& channel = "PLANEMAP_REPLY_A") {
    Request request;
    request.request_id = 7;
    request.reply_channel = channel;
    request.operation = operation;
    return request;
  }
  static reply_t only_page(const Reply& reply) {
    EXPECT_EQ(reply.end - reply.begin, 1u);
    return decoded<reply_t>({(*reply.pages)[reply.begin]})[0];
  }

  ServiceConfig config_;
  PlaneBook book_;
  RequestAnswerer answerer_;
  Walls walls_;
};

TEST_F(RequestAnswererTest, SnapshotHoldsAllPlanes) {
  const auto snapshot = walls_.snapshot();
  const auto reply = ask(request_for(request_t::OPERATION_SNAPSHOT), snapshot);
  EXPECT_EQ(reply.channel, "PLANEMAP_REPLY_A");
  const reply_t page = only_page(reply);
  EXPECT_EQ(page.status, reply_t::STATUS_OK);
  EXPECT_EQ(page.epoch, 9);
  EXPECT_EQ(page.revision, static_cast<std::int64_t>(snapshot->revision()));
  ASSERT_EQ(page.n_planes, 1);
  EXPECT_GE(page.planes[0].n_polygons, 1);
  EXPECT_EQ(page.n_cells, 0);
}

TEST_F(RequestAnswererTest, CellsComeInPagesAndEachCanBeAskedForAgain) {
  const auto snapshot = walls_.snapshot();
  std::size_t dense = 0;
  snapshot->for_each_cell([&](const CellView&) { ++dense; });
  ASSERT_GT(dense, 80u);
  const auto reply = ask(request_for(request_t::OPERATION_CELLS), snapshot);
  ASSERT_GE(reply.end, 2u);
  std::size_t cells = 0;
  for (const auto& page : decoded<reply_t>(*reply.pages)) cells += page.cells.size();
  EXPECT_EQ(cells, dense);
  auto again = request_for(request_t::OPERATION_CELLS);
  again.epoch = 9;
  again.revision = static_cast<std::int64_t>(snapshot->revision());
  again.page = 1;
  walls_.look_at(750, 1.5);  // the map goes on; the kept reply does not
  const auto lost = ask(again, walls_.snapshot());
  ASSERT_EQ(lost.begin, 1u);
  EXPECT_EQ(lost.end, 2u);
  EXPECT_EQ((*lost.pages)[1], (*reply.pages)[1]);
}

TEST_F(RequestAnswererTest, AnswersThatAreTooLargeAreRefusedWithWhatToAskInstead) {
  const auto snapshot = walls_.snapshot();
  const auto refusal_below = [&](std::size_t max_reply_bytes, const Request& request) {
    RequestAnswerer answerer(make_config(), book_, max_reply_bytes);
    const auto reply = answerer.answer(
        request, snapshot, [] { return planemap_lcm::status_t{}; }, 123);
    EXPECT_EQ(only_page(reply).status, reply_t::STATUS_TOO_LARGE);
    EXPECT_EQ(only_page(reply).n_cells, 0);
    return only_page(reply).error;
  };
  const std::string cells = std::to_string(snapshot->cell_count());
  const auto for_cells = request_for(request_t::OPERATION_CELLS);
  EXPECT_EQ(refusal_below(1000, for_cells),
            "the map's " + cells + " cells are more than 1000 bytes; ask for those of regions");
  const std::size_t just = 2 * snapshot->cell_count() * sizeof(planemap_lcm::cell_t);
  const auto pages = ask(for_cells, snapshot).end;
  EXPECT_EQ(refusal_below(4095, request_for(request_t::OPERATION_SNAPSHOT)),
            "the answer is 1 pages of 4096 bytes, more than 4095 bytes in all; ask for less at a time");
  RequestAnswerer enough(make_config(), book_, just);
  const auto reply = enough.answer(
      for_cells, snapshot, [] { return planemap_lcm::status_t{}; }, 123);
  EXPECT_EQ(reply.end, pages);
}

TEST_F(RequestAnswererTest, CellsCanBeHadOfTheRevisionOfThePlanes) {
  const auto snapshot = walls_.snapshot();
  ask(request_for(request_t::OPERATION_SNAPSHOT), snapshot);
  std::size_t dense = 0;
  snapshot->for_each_cell([&](const CellView&) { ++dense; });
  walls_.look_at(750, 1.5);  // the map goes on
  const auto newest = walls_.snapshot();
  ASSERT_GT(newest->revision(), snapshot->revision());
  const auto cells_of = [&](std::int64_t epoch, std::int64_t revision, const char* channel) {
    auto request = request_for(request_t::OPERATION_CELLS, channel);
    request.epoch = epoch;
    request.revision = revision;
    return decoded<reply_t>(*ask(request, newest).pages);
  };
  const auto revision = static_cast<std::int64_t>(snapshot->revision());
  for (const char* channel : {"PLANEMAP_REPLY_A", "PLANEMAP_REPLY_B"}) {  // who asked for the planes, and another
    std::size_t cells = 0;
    for (const auto& page : cells_of(9, revision, channel)) {
      EXPECT_EQ(page.status, reply_t::STATUS_OK) << page.error;
      EXPECT_EQ(page.epoch, 9);
      EXPECT_EQ(page.revision, revision);
      cells += page.cells.size();
    }
    EXPECT_EQ(cells, dense) << channel;
  }
  const auto newest_revision = static_cast<std::int64_t>(newest->revision());
  EXPECT_EQ(cells_of(9, newest_revision, "PLANEMAP_REPLY_A").at(0).revision, newest_revision);
  EXPECT_EQ(cells_of(0, 0, "PLANEMAP_REPLY_A").at(0).revision, newest_revision);
  for (const auto& [epoch, gone] : {std::pair<std::int64_t, std::int64_t>{9, 1000}, {8, newest_revision}}) {
    const auto pages = cells_of(epoch, gone, "PLANEMAP_REPLY_A");
    ASSERT_EQ(pages.size(), 1u);
    EXPECT_EQ(pages[0].status, reply_t::STATUS_GONE);
    EXPECT_NE(pages[0].error.find("is not kept any more: ask anew"), std::string::npos) << pages[0].error;
  }
}

TEST_F(RequestAnswererTest, CellsComeFromTheVerySnapshotOfThePlanes) {
  const auto snapshot = walls_.snapshot();
  ask(request_for(request_t::OPERATION_SNAPSHOT), snapshot);
  const auto twin = walls_.snapshot();  // of the same revision; it may hold more cells
  ASSERT_NE(twin, snapshot);
  ASSERT_EQ(twin->revision(), snapshot->revision());
  auto request = request_for(request_t::OPERATION_CELLS);
  request.epoch = 9;
  request.revision = static_cast<std::int64_t>(snapshot->revision());
  const auto reply = ask(request, twin);
  EXPECT_EQ(ask(request_for(request_t::OPERATION_CELLS, "PLANEMAP_REPLY_B"), snapshot).pages, reply.pages)
      << "made once for the snapshot, and kept";
}

TEST_F(RequestAnswererTest, StatusIsOnePage) {
  const reply_t page = only_page(ask(request_for(request_t::OPERATION_STATUS), walls_.snapshot()));
  EXPECT_EQ(page.status, reply_t::STATUS_OK);
  EXPECT_EQ(page.n_status, 1);
}

TEST_F(RequestAnswererTest, WrongRequestsGetAnErrorThatSaysWhy) {
  const auto snapshot = walls_.snapshot();
  ask(request_for(request_t::OPERATION_SNAPSHOT), snapshot);
  struct Case {
    std::int16_t operation;
    std::int32_t page;
    std::int64_t revision;
    std::int8_t status;
    const char* error;
  };
  const auto revision = static_cast<std::int64_t>(snapshot->revision());
  const Case cases[] = {
      {99, -1, 0, reply_t::STATUS_UNKNOWN_OPERATION,
       "operation 99 is not known (known: 1 status, 2 snapshot, 3 cells, 4 nearest, 5 rays, 6 region, 7 plane, 8 "
       "floorplan)"},
      {0, -1, 0, reply_t::STATUS_UNKNOWN_OPERATION, "operation 0 is not known"},
      {2, -2, 0, reply_t::STATUS_BAD_REQUEST, "page is -2"},
      {2, 5, revision, reply_t::STATUS_BAD_REQUEST, "page 5 of 1 (they are counted from 0)"},
      {2, 0, revision + 1, reply_t::STATUS_GONE, "is not kept any more"},
      {3, 0, revision, reply_t::STATUS_GONE, "is not kept any more"},
      {1, 1, 0, reply_t::STATUS_BAD_REQUEST, "page 1 of 1"},
  };
  for (const auto& c : cases) {
    auto request = request_for(c.operation);
    request.page = c.page;
    request.epoch = 9;
    request.revision = c.revision;
    const reply_t page = only_page(ask(request, snapshot));
    EXPECT_EQ(page.status, c.status) << c.error;
    EXPECT_NE(page.error.find(c.error), std::string::npos) << page.error;
    EXPECT_EQ(page.request_id, 7);
  }
}

TEST_F(RequestAnswererTest, OldRepliesAreForgottenAndOthersStay) {
  const auto snapshot = walls_.snapshot();
  for (const char* channel : {"PLANEMAP_REPLY_A", "PLANEMAP_REPLY_B", "PLANEMAP_REPLY_C"}) {
    ask(request_for(request_t::OPERATION_SNAPSHOT, channel), snapshot);
  }
  const auto status_of_lost_page = [&](const char* channel) {
    auto request = request_for(request_t::OPERATION_SNAPSHOT, channel);
    request.page = 0;
    request.epoch = 9;
    request.revision = static_cast<std::int64_t>(snapshot->revision());
    return only_page(ask(request, snapshot)).status;
  };
  EXPECT_EQ(status_of_lost_page("PLANEMAP_REPLY_A"), reply_t::STATUS_GONE);
  EXPECT_EQ(status_of_lost_page("PLANEMAP_REPLY_B"), reply_t::STATUS_OK);
  EXPECT_EQ(status_of_lost_page("PLANEMAP_REPLY_C"), reply_t::STATUS_OK);
}

/// A request for the planes nearest to so many points.
Request nearest_request(std::int32_t points, std::int32_t count, const std::string& channel = "PLANEMAP_REPLY_A") {
  Request request;
  request.request_id = 7;
  request.reply_channel = channel;
  request.operation = request_t::OPERATION_NEAREST;
  planemap_lcm::nearest_query_t query{};
  query.count = count;
  query.points.resize(static_cast<std::size_t>(points));
  query.n_points = points;
  request.arguments.nearest = {query};
  request.arguments.n_nearest = 1;
  request.argument_bytes = {static_cast<std::uint8_t>(points), static_cast<std::uint8_t>(count)};
  return request;
}

TEST_F(RequestAnswererTest, LostPagesOfAQueryAreThoseOfTheSameQuestion) {
  const auto snapshot = walls_.snapshot();
  const auto reply = ask(nearest_request(100, 1), snapshot);
  ASSERT_GT(reply.end, 1u) << "several pages";
  std::size_t near = 0;
  for (const auto& page : decoded<reply_t>(*reply.pages)) near += page.near_planes.size();
  EXPECT_EQ(near, 100u);
  auto again = nearest_request(100, 1);
  again.page = 1;
  again.epoch = 9;
  again.revision = static_cast<std::int64_t>(snapshot->revision());
  walls_.look_at(750, 1.5);
  const auto lost = ask(again, walls_.snapshot());
  ASSERT_EQ(lost.begin, 1u);
  EXPECT_EQ((*lost.pages)[1], (*reply.pages)[1]);
  auto other = nearest_request(50, 1);  // another question: never a page of that answer
  other.page = 1;
  other.epoch = again.epoch;
  other.revision = again.revision;
  EXPECT_EQ(only_page(ask(other, snapshot)).status, reply_t::STATUS_GONE);
}

TEST_F(RequestAnswererTest, TheSameQuestionTwiceGetsTheSameAnswer) {
  const auto snapshot = walls_.snapshot();
  const auto first = ask(nearest_request(3, 1), snapshot);
  EXPECT_EQ(ask(nearest_request(3, 1), snapshot).pages, first.pages) << "made once";
  EXPECT_EQ(ask(nearest_request(3, 1, "PLANEMAP_REPLY_B"), snapshot).pages, first.pages);
  EXPECT_NE(ask(nearest_request(4, 1), snapshot).pages, first.pages);
}

TEST_F(RequestAnswererTest, WrongArgumentsGetAnErrorThatSaysWhy) {
  const auto snapshot = walls_.snapshot();
  const auto expect_bad = [&](const Request& request, const char* why) {
    const reply_t page = only_page(ask(request, snapshot));
    EXPECT_EQ(page.status, reply_t::STATUS_BAD_REQUEST) << why;
    EXPECT_NE(page.error.find(why), std::string::npos) << page.error;
  };
  expect_bad(request_for(request_t::OPERATION_NEAREST), "nearest: operation 4 (nearest) takes one there, there are 0");
  auto request = request_for(request_t::OPERATION_RAYS);
  request.arguments.rays.resize(2);
  expect_bad(request, "rays: operation 5 (rays) takes one there, there are 2");
  request = request_for(request_t::OPERATION_FLOORPLAN);
  request.arguments.floorplan.resize(2);
  expect_bad(request, "floorplan: operation 8 (floorplan) takes one or none there, there are 2");
  request = request_for(request_t::OPERATION_STATUS);
  request.arguments.plane.resize(1);
  expect_bad(request, "plane: operation 1 (status) takes none there, there are 1");
  request = request_for(request_t::OPERATION_SNAPSHOT);
  request.arguments.filter.min_area_m2 = 1.0;
  expect_bad(request, "filter: operation 2 (snapshot) takes none; a region without limits does");
  request = request_for(request_t::OPERATION_REGION);
  request.arguments.region.resize(1);
  expect_bad(request, "shape: 0 is none (1 box, 2 oriented box, 3 sphere, 4 frustum, 5 cylinder)");
  expect_bad(nearest_request(701, 1), "points: there must be 1 to 700 in a request, there are 701");
  expect_bad(nearest_request(1, 1001), "count: must be 1 to 1000, is 1001");
  using planemap_lcm::region_query_t;
  const auto region = [](std::int8_t shape) {
    auto made = request_for(request_t::OPERATION_REGION);
    made.arguments.region.resize(1);
    made.arguments.region[0].shape = shape;
    return made;
  };
  request = region(region_query_t::SHAPE_BOX);
  expect_bad(request, "box.from_m.x: must be less than to_m's 0, is 0");
  request = region(region_query_t::SHAPE_SPHERE);
  request.arguments.region[0].from_m[1] = std::nan("");
  request.arguments.region[0].radius_m = 1.0;
  expect_bad(request, "sphere.from_m: not every coordinate is a finite number");
  request = region(region_query_t::SHAPE_ORIENTED_BOX);
  expect_bad(request, "oriented_box.rotation_wxyz: must be a unit quaternion, its length is 0");
  request.arguments.region[0].rotation_wxyz[0] = 1.0;
  expect_bad(request, "oriented_box.size_m.x: must be greater than 0");
  request.arguments.region[0].from_m[0] = 2e6;
  expect_bad(request, "oriented_box.from_m: coordinates may be at most 1e+06 m, one is 2e+06");
  request = region(region_query_t::SHAPE_FRUSTUM);
  request.arguments.region[0].rotation_wxyz[0] = 1.0;
  request.arguments.region[0].from_m[0] = 2e6;
  expect_bad(request, "frustum.from_m: coordinates may be at most 1e+06 m");
  request = region(region_query_t::SHAPE_CYLINDER);
  request.arguments.region[0].radius_m = 1.0;
  expect_bad(request, "cylinder.to_m: must not be the same point as from_m");
  request = nearest_request(1, 1);
  request.arguments.filter.classes.resize(17);
  expect_bad(request, "filter.classes: there may be 16, there are 17");
  request.arguments.filter.classes = {"wal"};
  expect_bad(request, "filter.classes: 'wal' is no class (floor, ceiling, wall, table, slope, other)");
  request.arguments.filter = {};
  request.arguments.filter.epoch = -1;
  expect_bad(request, "filter.epoch: must be at least 0, is -1");
  request = nearest_request(2, 1);
  request.arguments.nearest[0].points[1].sigma_m = -1.0;
  expect_bad(request, "points[1].sigma_m: must be finite and at least 0, is -1");
  request = request_for(request_t::OPERATION_RAYS);
  request.arguments.rays.resize(1);
  expect_bad(request, "rays: there must be 1 to 700 in a request, there are 0");
  request.arguments.rays[0].rays.resize(1);
  expect_bad(request, "planes, cells: one of them must be asked for");
  request.arguments.rays[0].cells = 1;
  expect_bad(request, "rays[0].direction: must not be zero");
  request = request_for(request_t::OPERATION_PLANE);
  request.arguments.plane.resize(1);
  expect_bad(request, "id: must be greater than 0, is 0");
  request = request_for(request_t::OPERATION_FLOORPLAN);
  expect_bad(request, "floorplan: which way is down is not known (map.gravity)");
}

TEST_F(RequestAnswererTest, WhereTheServiceItselfFailsTheReplySaysSo) {
  const auto reply = answerer_.answer(
      request_for(request_t::OPERATION_STATUS), walls_.snapshot(),
      []() -> planemap_lcm::status_t { throw std::runtime_error("out of luck"); }, 123);
  EXPECT_TRUE(reply.has_failed);
  const reply_t page = only_page(reply);
  EXPECT_EQ(page.status, reply_t::STATUS_FAILED);
  EXPECT_EQ(page.error, "the service could not answer: out of luck");
  EXPECT_EQ(page.request_id, 7);
  EXPECT_EQ(page.utime, 123);
  const auto large = answerer_.answer(
      request_for(request_t::OPERATION_STATUS), walls_.snapshot(),
      [] {
        planemap_lcm::status_t status{};
        status.idle_reason = std::string(5000, 'x');
        return status;
      },
      123);
  EXPECT_EQ(only_page(large).status, reply_t::STATUS_TOO_LARGE);
  EXPECT_EQ(only_page(large).error, "the status does not fit on a page (publish.page_bytes)");
  const auto wrong = ask(request_for(99), walls_.snapshot());
  EXPECT_FALSE(wrong.has_failed) << wrong.error;
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

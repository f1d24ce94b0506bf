// What wrong requests over LCM are answered with, in words.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "lcm/request_answerer_fixture.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::reply_t;
using planemap_lcm::request_t;

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

}  // namespace
}  // namespace planemap::service

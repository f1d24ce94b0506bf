// Questions that are wrong.
#include <cmath>
#include <string>
#include <vector>

#include "suite.hpp"

namespace planemap::client {
namespace {

/// The answer failed, and says why.
template <class Answer>
void expect_refused(const Answer& answer, const std::string& why) {
  ASSERT_FALSE(answer) << why;
  EXPECT_EQ(answer.error().kind, Error::Kind::kRefused) << answer.error().message;
  EXPECT_NE(answer.error().message.find(why), std::string::npos) << answer.error().message;
}

TEST_P(MapClientSuite, WrongQuestionsAreRefusedInWords) {
  const double nan = std::nan("");
  const std::vector<QueryPoint> one(1);
  NearestOptions nearest;
  nearest.filter.classes = {"wal"};
  expect_refused(client_->nearest(one, nearest, kLong), "filter.classes: 'wal' is no class (floor, ceiling, wall,");
  nearest = {};
  nearest.filter.epoch = 77;
  expect_refused(client_->nearest(one, nearest, kLong), "filter.epoch: the map is of epoch 1234, asked for is 77");
  nearest.filter.epoch = -1;
  expect_refused(client_->nearest(one, nearest, kLong), "filter.epoch: must be at least 0, is -1");
  nearest = {};
  nearest.filter.min_area_m2 = -1.0;
  expect_refused(client_->nearest(one, nearest, kLong), "filter.min_area_m2: must be finite and at least 0, is -1");
  nearest = {};
  nearest.filter.max_normal_deviation_rad = 0.0;
  expect_refused(client_->nearest(one, nearest, kLong),
                 "filter.max_normal_deviation_rad: must be greater than 0, is 0");
  nearest = {};
  nearest.count = 0;
  expect_refused(client_->nearest(one, nearest, kLong), "count: must be 1 to 1000, is 0");
  nearest = {};
  nearest.max_distance_m = -2.0;
  expect_refused(client_->nearest(one, nearest, kLong), "max_distance_m: must be greater than 0, is -2");
  expect_refused(client_->nearest({}, {}, kLong), "points: there must be one at least");
  std::vector<QueryPoint> points(2);
  points[1].point_m[2] = nan;
  expect_refused(client_->nearest(points, {}, kLong), "points[1].point_m: not every coordinate is a finite number");
  points = std::vector<QueryPoint>(2);
  points[1].sigma_m = -0.5;
  expect_refused(client_->nearest(points, {}, kLong), "points[1].sigma_m: must be finite and at least 0, is -0.5");
  points[1].sigma_m = 0.0;
  points[1].covariance_m2 = {1, 2, 0, 2, 1, 0, 0, 0, 1};
  expect_refused(client_->nearest(points, {}, kLong), "points[1].covariance_m2: is not positive semi-definite");
  points[1].covariance_m2 = {1, 0.5, 0, 0, 1, 0, 0, 0, 1};
  expect_refused(client_->nearest(points, {}, kLong), "points[1].covariance_m2: is not symmetric");

  std::vector<client::Ray> rays = {{{0, 0, 0}, {0, 0, 0}}};
  expect_refused(client_->cast(rays, {}, kLong), "rays[0].direction: must not be zero");
  rays[0] = {{0, 0, 0}, {1, 0, 0}, -1.0};
  expect_refused(client_->cast(rays, {}, kLong), "rays[0].max_range_m: must be greater than 0, is -1");
  rays[0] = {{0, 0, 0}, {1, 0, 0}};
  expect_refused(client_->cast({}, {}, kLong), "rays: there must be one at least");
  expect_refused(client_->cast(rays, {false, false, {}}, kLong), "planes, cells: one of them must be asked for");

  const auto region = [&](client::Region shape) {
    return client_->region({std::move(shape), false, false, {}}, kLong);
  };
  expect_refused(region(Box{{1, 0, 0}, {0, 1, 1}}), "box.min_m.x: must be less than max_m's 0, is 1");
  expect_refused(region(Sphere{{0, 0, 0}, -1}), "sphere.radius_m: must be greater than 0");
  expect_refused(region(Sphere{{nan, 0, 0}, 1}), "sphere.centre_m: not every coordinate is a finite number");
  expect_refused(region(OrientedBox{{{0, 0, 2e6}}, {1, 1, 1}}),
                 "oriented_box.pose.position_m: coordinates may be at most 1e+06 m, one is 2e+06");
  expect_refused(region(Frustum{{{0, 0, 2e6}}, 1.0, 1.0, 0.0, 1.0}), "frustum.pose.position_m: coordinates may be at");
  expect_refused(region(OrientedBox{{{}, {1, 1, 0, 0}}, {1, 1, 1}}),
                 "must be a unit quaternion, its length is 1.41421");
  expect_refused(region(Frustum{{}, 4.0, 1.0, 0.0, 1.0}), "frustum.horizontal_rad: must be greater than 0 and less");
  expect_refused(region(Cylinder{{1, 1, 1}, {1, 1, 1}, 1.0}), "cylinder.to_m: must not be the same point as from_m");
  expect_refused(client_->plane(0, kLong), "id: must be greater than 0, is 0");
  FloorplanQuery plan;
  plan.cut_high_m = 0.5;
  expect_refused(client_->floorplan(plan, kLong), "cut_high_m: must be finite and greater than cut_low_m's 0.9");
}

}  // namespace
}  // namespace planemap::client

// Regions, filters and floor plans.
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "suite.hpp"

namespace planemap::client {
namespace {

TEST_P(MapClientSuite, RegionsOfEveryShapeHoldWhatTheCoreFindsInThem) {
  const double infinite = std::numeric_limits<double>::infinity();
  const double turn = std::sqrt(0.5);  // a quarter turn about z
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.linear() = Eigen::Quaterniond(turn, 0, 0, turn).normalized().toRotationMatrix();
  turned.translation() = Eigen::Vector3d(1.0, -1.2, 1.0);
  // A camera's z looks along the world's x: the axes x, y, z become -y, -z, x.
  Eigen::Isometry3d camera = Eigen::Isometry3d::Identity();
  camera.linear() = Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5).toRotationMatrix();
  camera.translation() = Eigen::Vector3d(-1.0, 1.0, 1.0);
  const std::vector<std::pair<client::Region, planemap::Region>> shapes = {
      {Box{{-infinite, -infinite, -infinite}, {infinite, infinite, infinite}},
       BoxRegion{Eigen::Vector3d::Constant(-infinite), Eigen::Vector3d::Constant(infinite)}},
      {Box{{-0.2, -0.3, -0.5}, {2.0, 1.3, 0.9}}, BoxRegion{{-0.2, -0.3, -0.5}, {2.0, 1.3, 0.9}}},
      {OrientedBox{{{1.0, -1.2, 1.0}, {turn, 0, 0, turn}}, {0.4, 1.0, 0.5}},
       OrientedBoxRegion{turned, {0.4, 1.0, 0.5}}},
      {Sphere{{1.0, 1.2, 1.0}, 0.3}, SphereRegion{{1.0, 1.2, 1.0}, 0.3}},
      {Frustum{{{-1.0, 1.0, 1.0}, {0.5, -0.5, 0.5, -0.5}}, 0.3, 0.2, 0.5, 3.0},
       FrustumRegion{camera, 0.3, 0.2, 0.5, 3.0}},
      {Cylinder{{0.1, 0.1, -1.0}, {0.1, 0.1, 1.0}, 0.2}, CylinderRegion{{0.1, 0.1, -1.0}, {0.1, 0.1, 1.0}, 0.2}},
      {Sphere{{50, 50, 50}, 1.0}, SphereRegion{{50, 50, 50}, 1.0}},
  };
  std::size_t planes = 0;
  for (const auto& [shape, core_shape] : shapes) {
    const auto answer = client_->region({shape, /*polygons=*/true, /*cells=*/true, {}}, kLong);
    ASSERT_TRUE(answer) << answer.error().message;
    expect_newest(answer->version);
    const auto expected = core()->region({core_shape, true, true, {}});
    ASSERT_TRUE(expected) << expected.error().message;
    ASSERT_EQ(answer->planes.size(), expected->planes.size()) << "shape " << shape.index();
    for (std::size_t i = 0; i < expected->planes.size(); ++i, ++planes) {
      EXPECT_EQ(answer->planes[i].plane.id, static_cast<std::int64_t>(expected->planes[i].plane.record->id));
      EXPECT_EQ(answer->planes[i].whole, expected->planes[i].whole);
      EXPECT_NEAR(answer->planes[i].clipped_area_m2, expected->planes[i].area_m2, 1e-9);
      EXPECT_EQ(answer->planes[i].clipped.size(), expected->planes[i].polygons.size());
      EXPECT_FALSE(answer->planes[i].plane.polygons.empty());
    }
    EXPECT_EQ(answer->cells.size(), expected->cells.size()) << "shape " << shape.index();
  }
  EXPECT_GE(planes, 8u);
  const auto bare = client_->region({shapes[0].first, false, false, {}}, kLong);
  ASSERT_TRUE(bare);
  ASSERT_EQ(bare->planes.size(), 3u);
  EXPECT_TRUE(bare->planes[0].clipped.empty());
  EXPECT_TRUE(bare->cells.empty());
}

TEST_P(MapClientSuite, FiltersHoldEverywhere) {
  PlaneFilter walls;
  walls.classes = {"wall"};
  const std::int64_t floor = id_of_class(PlaneClass::kFloor);
  ASSERT_NE(floor, 0);
  const std::vector<QueryPoint> points(1);  // on the floor
  NearestOptions nearest;
  nearest.filter = walls;
  const auto near = client_->nearest(points, nearest, kLong);
  ASSERT_TRUE(near) << near.error().message;
  ASSERT_EQ(near->points[0].size(), 1u);
  EXPECT_NE(near->points[0][0].plane_id, floor);
  const std::vector<client::Ray> down = {{{0, 0, 1}, {0, 0, -1}}};
  const auto hits = client_->cast(down, {true, true, walls}, kLong);
  ASSERT_TRUE(hits) << hits.error().message;
  EXPECT_FALSE(hits->rays[0].plane || hits->rays[0].cell);
  const auto count = [&](const PlaneFilter& filter) {
    const double far_m = std::numeric_limits<double>::infinity();
    const auto region =
        client_->region({Box{{-far_m, -far_m, -far_m}, {far_m, far_m, far_m}}, false, false, filter}, kLong);
    return region ? region->planes.size() : 99;
  };
  PlaneFilter filter;
  EXPECT_EQ(count(filter), 3u);
  EXPECT_EQ(count(walls), 2u);
  filter.min_area_m2 = 100.0;
  EXPECT_EQ(count(filter), 0u);
  filter = {};
  filter.max_normal_deviation_rad = 1e-9;
  EXPECT_EQ(count(filter), 0u);
  filter = {};
  filter.seen_since_utime = 10'000'000 + 2'500'000;  // the third look
  EXPECT_EQ(count(filter), 1u);
  filter = {};
  filter.epoch = 1234;
  EXPECT_EQ(count(filter), 3u);
}

TEST_P(MapClientSuite, TheFloorPlanIsThatOfTheCore) {
  FloorplanQuery query;
  query.wall_thickness_m = 0.2;
  const auto plan = client_->floorplan(query, kLong);
  ASSERT_TRUE(plan) << plan.error().message;
  expect_newest(plan->version);
  planemap::FloorplanQuery core_query;
  core_query.wall_thickness_m = 0.2;
  const auto expected = core()->floorplan(core_query);
  ASSERT_TRUE(expected) << expected.error().message;
  EXPECT_TRUE(vector_of(plan->up).isApprox(expected->axes.up, 1e-12));
  EXPECT_EQ(vector_of(plan->axis_x), expected->axes.axis_x);
  EXPECT_NEAR(plan->floor_height_m, expected->floor_height_m, 1e-12);
  EXPECT_EQ(plan->free_area_m2, expected->free_area_m2);
  EXPECT_EQ(plan->walls.size(), expected->walls.size());
  EXPECT_EQ(plan->floor.size(), expected->floor.size());
  EXPECT_EQ(plan->free_floor.size(), expected->free_floor.size());
  ASSERT_FALSE(plan->walls.empty());
  ASSERT_FALSE(plan->floor.empty());
  ASSERT_EQ(plan->floor[0].outer.size(), expected->floor[0].outer.size());
  for (std::size_t i = 0; i < plan->floor[0].outer.size(); ++i) {
    EXPECT_NEAR(plan->floor[0].outer[i][0], expected->floor[0].outer[i].x(), 1e-6);
    EXPECT_NEAR(plan->floor[0].outer[i][1], expected->floor[0].outer[i].y(), 1e-6);
  }
}

}  // namespace
}  // namespace planemap::client

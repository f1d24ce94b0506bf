// Batches of points and rays.
#include <cmath>
#include <random>
#include <vector>

#include "suite.hpp"

namespace planemap::client {
namespace {

TEST_P(MapClientSuite, NearestIsWhatTheCoreFinds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-2.0, 2.0);
  std::vector<QueryPoint> points(3000);  // more than one request over LCM brings (700), or over gRPC
  for (QueryPoint& point : points) {
    point.point_m = {coordinate(random), coordinate(random), coordinate(random)};
    point.sigma_m = 0.01 * std::abs(coordinate(random));
    point.covariance_m2 = {4e-4, 1e-4, 0, 1e-4, 1e-4, 2e-5, 0, 2e-5, 9e-4};
  }
  NearestOptions options;
  options.count = 2;
  options.max_distance_m = 2.5;
  const auto answer = client_->nearest(points, options, kLong);
  ASSERT_TRUE(answer) << answer.error().message;
  expect_newest(answer->version);
  ASSERT_EQ(answer->points.size(), points.size());
  std::size_t found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    NearestQuery query;
    query.point_m = vector_of(points[i].point_m);
    query.covariance_m2 << 4e-4, 1e-4, 0, 1e-4, 1e-4, 2e-5, 0, 2e-5, 9e-4;
    query.covariance_m2.diagonal().array() += points[i].sigma_m * points[i].sigma_m;
    query.count = 2;
    query.max_distance_m = 2.5;
    const auto expected = core()->nearest(query);
    ASSERT_TRUE(expected);
    ASSERT_EQ(answer->points[i].size(), expected->size()) << i;
    for (std::size_t k = 0; k < expected->size(); ++k, ++found) {
      const NearPlane& near = answer->points[i][k];
      EXPECT_EQ(near.plane_id, static_cast<std::int64_t>((*expected)[k].id));
      EXPECT_EQ(near.surface_distance_m, (*expected)[k].surface_distance_m);
      EXPECT_EQ(vector_of(near.surface_point_m), (*expected)[k].surface_point_m);
      EXPECT_EQ(near.signed_distance_m, (*expected)[k].signed_distance_m);
      EXPECT_EQ(near.sigma_m, (*expected)[k].sigma_m);
      EXPECT_EQ(near.mahalanobis, (*expected)[k].mahalanobis);
      EXPECT_EQ(vector_of(near.foot_m), (*expected)[k].foot_m);
      EXPECT_EQ(near.foot_inside, (*expected)[k].foot_inside);
    }
  }
  EXPECT_GT(found, 4000u);
}

TEST_P(MapClientSuite, RaysMeetWhatTheCoreMeets) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
  std::vector<client::Ray> rays(2500);
  std::vector<planemap::Ray> core_rays;
  for (client::Ray& ray : rays) {
    ray.origin_m = {coordinate(random), coordinate(random), 1.0};
    ray.direction = {coordinate(random), coordinate(random), coordinate(random)};
    if (core_rays.size() % 3 == 0) ray.max_range_m = 1.2;
    core_rays.push_back({vector_of(ray.origin_m), vector_of(ray.direction), ray.max_range_m});
  }
  const auto answer = client_->cast(rays, {}, kLong);
  ASSERT_TRUE(answer) << answer.error().message;
  expect_newest(answer->version);
  const auto expected = core()->cast(core_rays);
  ASSERT_TRUE(expected);
  ASSERT_EQ(answer->rays.size(), rays.size());
  std::size_t planes = 0;
  std::size_t cells = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const client::RayHits& hits = answer->rays[i];
    ASSERT_EQ(hits.plane.has_value(), (*expected)[i].plane.has_value()) << i;
    ASSERT_EQ(hits.cell.has_value(), (*expected)[i].cell.has_value()) << i;
    if (hits.plane) {
      ++planes;
      const planemap::PlaneHit& hit = *(*expected)[i].plane;
      EXPECT_EQ(hits.plane->plane_id, static_cast<std::int64_t>(hit.id));
      EXPECT_EQ(hits.plane->range_m, hit.range_m);
      EXPECT_EQ(hits.plane->sigma_m, hit.sigma_m);
      EXPECT_EQ(hits.plane->incidence_rad, hit.incidence_rad);
      EXPECT_EQ(hits.plane->from_behind, hit.from_behind);
      EXPECT_EQ(vector_of(hits.plane->point_m), hit.point_m);
    }
    if (hits.cell) {
      ++cells;
      const planemap::CellHit& hit = *(*expected)[i].cell;
      EXPECT_EQ(hits.cell->cell.plane_id, static_cast<std::int64_t>(hit.cell.plane_id));
      EXPECT_EQ(hits.cell->cell.count, static_cast<std::int64_t>(hit.cell.count));
      EXPECT_EQ(hits.cell->entry_m, hit.entry_m);
      EXPECT_EQ(hits.cell->range_m, hit.range_m);
      EXPECT_EQ(hits.cell->sigma_m, hit.sigma_m);
      EXPECT_EQ(hits.cell->incidence_rad, hit.incidence_rad);
    }
  }
  EXPECT_GT(planes, 100u);
  EXPECT_GT(cells, 100u);
}

TEST_P(MapClientSuite, RaysMayLookForPlanesOrCellsAlone) {
  const std::vector<client::Ray> rays = {{{0, 0, 1}, {0, 0, -1}}};
  client::CastOptions options;
  options.cells = false;
  auto hits = client_->cast(rays, options, kLong);
  ASSERT_TRUE(hits) << hits.error().message;
  EXPECT_TRUE(hits->rays[0].plane);
  EXPECT_FALSE(hits->rays[0].cell);
  options = {};
  options.planes = false;
  hits = client_->cast(rays, options, kLong);
  ASSERT_TRUE(hits) << hits.error().message;
  EXPECT_FALSE(hits->rays[0].plane);
  EXPECT_TRUE(hits->rays[0].cell);
}

}  // namespace
}  // namespace planemap::client

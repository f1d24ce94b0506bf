// What every MapClient does, whichever way it reaches the map: a real service, asked beside the core's own queries.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <planemap/client/in_process_map_client.hpp>
#include <planemap/client/lcm_map_client.hpp>
#include <planemap/client/service_source.hpp>
#include <random>

#include "support/room_service.hpp"

namespace planemap::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLong(30000);
constexpr milliseconds kShort(50);

struct Implementation {
  const char* name;
  std::unique_ptr<MapClient> (*make)(RoomService& room);
};

const Implementation kImplementations[] = {
    {"InProcess",
     [](RoomService& room) -> std::unique_ptr<MapClient> {
       return std::make_unique<InProcessMapClient>(source_of(room.service(), "world"));
     }},
    {"Lcm", [](RoomService& room) -> std::unique_ptr<MapClient> { return std::make_unique<LcmMapClient>(room.bus()); }},
};

class MapClientSuite : public testing::TestWithParam<Implementation> {
 protected:
  MapClientSuite() { room_.look_around(); }

  static Eigen::Vector3d vector_of(const Vector3& v) { return {v[0], v[1], v[2]}; }
  static Vector3 array_of(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
  std::shared_ptr<const SnapshotQueries> core() { return room_.service().queries(); }
  std::int64_t id_of_class(PlaneClass wanted) {
    for (const auto& plane : core()->planes()) {
      if (plane.plane_class == wanted) return static_cast<std::int64_t>(plane.record->id);
    }
    return 0;
  }
  void expect_newest(const MapVersion& version) {
    EXPECT_EQ(version.epoch, 1234);
    EXPECT_EQ(version.revision, static_cast<std::int64_t>(room_.service().snapshot()->revision()));
  }
  /// The answer failed, and says why.
  template <class Answer>
  static void expect_refused(const Answer& answer, const std::string& why) {
    ASSERT_FALSE(answer) << why;
    EXPECT_EQ(answer.error().kind, Error::Kind::kRefused) << answer.error().message;
    EXPECT_NE(answer.error().message.find(why), std::string::npos) << answer.error().message;
  }

  RoomService room_;
  std::unique_ptr<MapClient> client_ = GetParam().make(room_);
};

TEST_P(MapClientSuite, StatusSaysHowTheServiceIs) {
  const auto status = client_->status(kLong);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(status->epoch, 1234);
  EXPECT_EQ(status->plane_count, 3);
  EXPECT_EQ(status->counters.at("scans.mapped"), 3);
}

TEST_P(MapClientSuite, TheWholeMapIsThatOfTheService) {
  const auto map = client_->whole_map(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->frame, "world");
  EXPECT_EQ(map->epoch, 1234);
  const auto queries = core();
  ASSERT_EQ(map->planes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const DescribedPlane& plane = queries->planes()[i];
    EXPECT_EQ(map->planes[i].id, static_cast<std::int64_t>(plane.record->id));
    EXPECT_EQ(vector_of(map->planes[i].normal), plane.record->plane.normal());
    EXPECT_EQ(map->planes[i].d, plane.record->plane.d());
    EXPECT_EQ(map->planes[i].area_m2, plane.outline->area_m2);
    EXPECT_EQ(map->planes[i].plane_class, name_of(plane.plane_class));
    EXPECT_EQ(map->planes[i].polygons.size(), plane.outline->polygons.size());
  }
  std::size_t cells = 0;
  queries->snapshot().for_each_cell([&](const CellView&) { ++cells; });
  EXPECT_EQ(map->cells.size(), cells);
  EXPECT_EQ(client_->snapshot(kLong)->planes.size(), 3u);
  EXPECT_EQ(client_->cells(kLong)->cells.size(), cells);
}

TEST_P(MapClientSuite, NearestIsWhatTheCoreFinds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-2.0, 2.0);
  std::vector<QueryPoint> points(1500);  // more than one request over LCM brings
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
  EXPECT_GT(found, 2000u);
}

TEST_P(MapClientSuite, RaysMeetWhatTheCoreMeets) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
  std::vector<client::Ray> rays(1500);
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

TEST_P(MapClientSuite, APlaneIsToldWithWhatBecameOfIt) {
  const auto walls = core();
  const std::int64_t floor = id_of_class(PlaneClass::kFloor);
  const auto lives = client_->plane(floor, kLong);
  ASSERT_TRUE(lives) << lives.error().message;
  expect_newest(lives->version);
  EXPECT_EQ(lives->fate, PlaneFate::kLives);
  EXPECT_EQ(lives->lineage, (std::vector<std::int64_t>{floor}));
  EXPECT_FALSE(lives->removed_revision);
  ASSERT_TRUE(lives->plane);
  EXPECT_EQ(lives->plane->plane_class, "floor");
  EXPECT_GT(lives->normal_deviation_rad, 0.0);

  const auto before = client_->snapshot(kLong);
  ASSERT_TRUE(before);
  std::vector<std::int64_t> pieces;
  for (const Plane& plane : before->planes) {
    if (plane.plane_class == "wall") pieces.push_back(plane.id);
  }
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(client_->plane(pieces[0], kLong)->coplanar, (std::vector<std::int64_t>{pieces[1]}));

  room_.join_walls();
  const auto merged = client_->plane(pieces[1], kLong);
  ASSERT_TRUE(merged) << merged.error().message;
  EXPECT_EQ(merged->fate, PlaneFate::kMerged);
  EXPECT_EQ(merged->asked, pieces[1]);
  EXPECT_EQ(merged->lineage, (std::vector<std::int64_t>{pieces[1], pieces[0]}));
  EXPECT_TRUE(merged->removed_revision);
  ASSERT_TRUE(merged->plane);
  EXPECT_EQ(merged->plane->id, pieces[0]);
  EXPECT_NE(std::find(merged->merged.begin(), merged->merged.end(), pieces[1]), merged->merged.end());
  EXPECT_TRUE(merged->coplanar.empty());

  const auto unknown = client_->plane(99999, kLong);
  ASSERT_TRUE(unknown) << unknown.error().message;
  EXPECT_EQ(unknown->fate, PlaneFate::kUnknown);
  EXPECT_FALSE(unknown->plane);
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
  EXPECT_EQ(vector_of(plan->up), expected->axes.up);
  EXPECT_EQ(vector_of(plan->axis_x), expected->axes.axis_x);
  EXPECT_EQ(plan->floor_height_m, expected->floor_height_m);
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

TEST_P(MapClientSuite, WrongQuestionsAreRefusedInWords) {
  const double nan = std::nan("");
  const std::vector<QueryPoint> one(1);
  NearestOptions nearest;
  nearest.filter.classes = {"wal"};
  expect_refused(client_->nearest(one, nearest, kLong), "classes: 'wal' is no class (floor, ceiling, wall,");
  nearest = {};
  nearest.filter.epoch = 77;
  expect_refused(client_->nearest(one, nearest, kLong), "epoch: the map is of epoch 1234, asked for is 77");
  nearest.filter.epoch = -1;
  expect_refused(client_->nearest(one, nearest, kLong), "epoch: must be at least 0, is -1");
  nearest = {};
  nearest.filter.min_area_m2 = -1.0;
  expect_refused(client_->nearest(one, nearest, kLong), "min_area_m2: must be finite and at least 0, is -1");
  nearest = {};
  nearest.filter.max_normal_deviation_rad = 0.0;
  expect_refused(client_->nearest(one, nearest, kLong), "max_normal_deviation_rad: must be greater than 0, is 0");
  nearest = {};
  nearest.count = 0;
  expect_refused(client_->nearest(one, nearest, kLong), "count: must be 1 to 1000, is 0");
  nearest = {};
  nearest.max_distance_m = -2.0;
  expect_refused(client_->nearest(one, nearest, kLong), "max_distance_m: must be greater than 0, is -2");
  expect_refused(client_->nearest({}, {}, kLong), "points: there must be 1 to 700 in a request, there are 0");
  std::vector<QueryPoint> points(2);
  points[1].point_m[2] = nan;
  expect_refused(client_->nearest(points, {}, kLong), "points[1]: point_m: not every coordinate is a finite number");
  points = std::vector<QueryPoint>(2);
  points[1].sigma_m = -0.5;
  expect_refused(client_->nearest(points, {}, kLong), "points[1].sigma_m: must be finite and at least 0, is -0.5");
  points[1].sigma_m = 0.0;
  points[1].covariance_m2 = {1, 2, 0, 2, 1, 0, 0, 0, 1};
  expect_refused(client_->nearest(points, {}, kLong), "points[1]: covariance_m2: is not positive semi-definite");
  points[1].covariance_m2 = {1, 0.5, 0, 0, 1, 0, 0, 0, 1};
  expect_refused(client_->nearest(points, {}, kLong), "points[1].covariance_m2: is not symmetric");

  std::vector<client::Ray> rays = {{{0, 0, 0}, {0, 0, 0}}};
  expect_refused(client_->cast(rays, {}, kLong), "rays[0].direction: must not be zero");
  rays[0] = {{0, 0, 0}, {1, 0, 0}, -1.0};
  expect_refused(client_->cast(rays, {}, kLong), "rays[0].max_range_m: must be greater than 0, is -1");
  rays[0] = {{0, 0, 0}, {1, 0, 0}};
  expect_refused(client_->cast(rays, {false, false, {}}, kLong), "planes, cells: one of them must be asked for");

  const auto region = [&](client::Region shape) {
    return client_->region({std::move(shape), false, false, {}}, kLong);
  };
  expect_refused(region(Box{{1, 0, 0}, {0, 1, 1}}), "box.min_m.x: must be less than max_m's 0, is 1");
  expect_refused(region(Sphere{{0, 0, 0}, -1}), "sphere.radius_m: must be greater than 0");
  expect_refused(region(OrientedBox{{{}, {1, 1, 0, 0}}, {1, 1, 1}}),
                 "oriented_box.rotation_wxyz: must be a unit quaternion, its length is 1.41421");
  expect_refused(region(Frustum{{}, 4.0, 1.0, 0.0, 1.0}), "frustum.horizontal_rad: must be greater than 0 and less");
  expect_refused(region(Cylinder{{1, 1, 1}, {1, 1, 1}, 1.0}), "cylinder.to_m: must not be the same point as from_m");
  expect_refused(client_->plane(0, kLong), "id: must be greater than 0, is 0");
  FloorplanQuery plan;
  plan.cut_high_m = 0.5;
  expect_refused(client_->floorplan(plan, kLong), "cut_high_m: must be finite and greater than cut_low_m's 0.9");
}

TEST_P(MapClientSuite, AWatchTellsWhatChanges) {
  const auto watch = client_->watch();
  auto change = watch->next(kLong);
  ASSERT_TRUE(change) << change.error().message;
  EXPECT_TRUE(change->new_map);
  EXPECT_EQ(change->since_revision, -1);
  EXPECT_EQ(change->epoch, 1234);
  EXPECT_EQ(change->added.size(), 3u);
  EXPECT_EQ(watch->map().planes.size(), 3u);
  auto quiet = watch->next(kShort);
  ASSERT_TRUE(quiet) << quiet.error().message;
  EXPECT_TRUE(quiet->empty());

  std::vector<std::int64_t> walls;
  for (const Plane& plane : watch->map().planes) {
    if (plane.plane_class == "wall") walls.push_back(plane.id);
  }
  ASSERT_EQ(walls.size(), 2u);
  room_.join_walls();
  const auto revision = static_cast<std::int64_t>(room_.service().snapshot()->revision());
  std::vector<std::int64_t> changed;
  std::vector<std::int64_t> removed;
  while (watch->map().revision < revision) {
    const std::int64_t before = watch->map().revision;
    change = watch->next(kLong);
    ASSERT_TRUE(change) << change.error().message;
    EXPECT_EQ(change->since_revision, before);
    EXPECT_FALSE(change->new_map);
    for (const std::int64_t id : change->changed) changed.push_back(id);
    for (const auto& gone : change->removed) removed.push_back(gone.id);
  }
  EXPECT_EQ(changed, (std::vector<std::int64_t>{walls[0]}));
  EXPECT_EQ(removed, (std::vector<std::int64_t>{walls[1]}));
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map);
  ASSERT_EQ(watch->map().planes.size(), map->planes.size());
  for (std::size_t i = 0; i < map->planes.size(); ++i) {
    EXPECT_EQ(watch->map().planes[i].id, map->planes[i].id);
    EXPECT_EQ(watch->map().planes[i].revision, map->planes[i].revision);
    EXPECT_EQ(watch->map().planes[i].polygons.size(), map->planes[i].polygons.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Clients, MapClientSuite, testing::ValuesIn(kImplementations),
                         [](const auto& test) { return std::string(test.param.name); });

/// Without gravity, and with nothing in it.
class EmptyMapSuite : public testing::TestWithParam<Implementation> {
 protected:
  RoomService room_{service::ServiceConfig{}};
  std::unique_ptr<MapClient> client_ = GetParam().make(room_);
};

TEST_P(EmptyMapSuite, AnEmptyMapAnswersWithNothing) {
  const std::vector<QueryPoint> points(3);
  const auto near = client_->nearest(points, {}, kLong);
  ASSERT_TRUE(near) << near.error().message;
  ASSERT_EQ(near->points.size(), 3u);
  EXPECT_TRUE(near->points[2].empty());
  const std::vector<client::Ray> rays = {{{0, 0, 0}, {1, 0, 0}}};
  const auto hits = client_->cast(rays, {}, kLong);
  ASSERT_TRUE(hits) << hits.error().message;
  ASSERT_EQ(hits->rays.size(), 1u);
  EXPECT_FALSE(hits->rays[0].plane);
  EXPECT_TRUE(client_->region({Sphere{{0, 0, 0}, 1}, true, true, {}}, kLong)->planes.empty());
  EXPECT_EQ(client_->plane(1, kLong)->fate, PlaneFate::kUnknown);
  const auto plan = client_->floorplan({}, kLong);
  ASSERT_FALSE(plan);
  EXPECT_NE(plan.error().message.find("floorplan: which way is down is not known (map.gravity)"), std::string::npos)
      << plan.error().message;
  const auto watch = client_->watch();
  const auto change = watch->next(kLong);
  ASSERT_TRUE(change) << change.error().message;
  EXPECT_TRUE(change->new_map);
  EXPECT_TRUE(change->added.empty());
}

INSTANTIATE_TEST_SUITE_P(Clients, EmptyMapSuite, testing::ValuesIn(kImplementations),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace planemap::client

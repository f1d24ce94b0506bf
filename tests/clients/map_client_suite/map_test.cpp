// Status, the whole map, one plane, an empty map.
#include <algorithm>
#include <vector>

#include "suite.hpp"

namespace planemap::client {
namespace {

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

}  // namespace
}  // namespace planemap::client

#include "planemap/query/snapshot_queries.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <planemap/mapper.hpp>

#include "query/random_map.hpp"
#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;

/// A room of 5 m by 4 m by 2.5 m with its floor at z = 0, and a box of 1 m by 1 m by 0.8 m on the floor by the wall x =
/// 2.5: top and the side towards the room's middle.
std::vector<testing::Wall> room_with_box() {
  return {{Vector3d::UnitZ(), 0.0},
          {-Vector3d::UnitZ(), 2.5},
          {Vector3d::UnitX(), 2.5},
          {-Vector3d::UnitX(), 2.5},
          {Vector3d::UnitY(), 2.0},
          {-Vector3d::UnitY(), 2.0},
          {Vector3d::UnitZ(), -0.8, [](const Vector3d& p) { return p.x() > 1.5 && std::abs(p.y()) < 0.5; }},
          {-Vector3d::UnitX(), 1.5, [](const Vector3d& p) { return p.z() < 0.8 && std::abs(p.y()) < 0.5; }},
          {Vector3d::UnitY(), -0.5, [](const Vector3d& p) { return p.z() < 0.8 && p.x() > 1.5; }},
          {-Vector3d::UnitY(), -0.5, [](const Vector3d& p) { return p.z() < 0.8 && p.x() > 1.5; }}};
}

/// Looks round from a corner's side of the room, then from the opposite one.
void look_round(Mapper& mapper, const Vector3d& from_m, int steps) {
  for (int i = 0; i < steps; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / steps;
    const double tilt = i % 2 == 0 ? -1.4 : -0.3;
    const Vector3d at_m = from_m + Vector3d(std::cos(angle_rad), std::sin(angle_rad), tilt);
    const Eigen::Isometry3d T = testing::looking(from_m, at_m);
    mapper.integrate(testing::render(room_with_box(), T, static_cast<std::uint64_t>(100 + i)), T);
  }
}

struct MappedRoom {
  std::shared_ptr<const MapSnapshot> early;
  std::shared_ptr<const MapSnapshot> late;
};

const MappedRoom& mapped_room() {
  static const MappedRoom room = [] {
    MappedRoom made;
    Mapper mapper(preset(Preset::kBest), 5);
    look_round(mapper, {-1.0, 1.0, 1.4}, 24);
    made.early = mapper.snapshot();
    look_round(mapper, {-1.0, -1.0, 1.4}, 2);
    made.late = mapper.snapshot();
    return made;
  }();
  return room;
}

const Vector3d kDown = -Vector3d::UnitZ();

TEST(SnapshotQueries, TakesOverWhatHasNotChanged) {
  const SnapshotQueries early(mapped_room().early, kDown);
  const SnapshotQueries late(mapped_room().late, kDown, &early);
  const SnapshotQueries anew(mapped_room().late, kDown);
  std::size_t kept = 0;
  ASSERT_EQ(late.planes().size(), anew.planes().size());
  ASSERT_GE(late.planes().size(), 6U);
  for (std::size_t i = 0; i < late.planes().size(); ++i) {
    const DescribedPlane& plane = late.planes()[i];
    EXPECT_EQ(plane.record, anew.planes()[i].record);
    EXPECT_EQ(plane.plane_class, anew.planes()[i].plane_class);
    EXPECT_EQ(plane.outline->area_m2, anew.planes()[i].outline->area_m2);
    for (const DescribedPlane& before : early.planes()) {
      if (before.record != plane.record) continue;
      EXPECT_EQ(before.outline, plane.outline) << "the same object";
      ++kept;
    }
  }
  EXPECT_GT(kept, 0U);
  EXPECT_LT(kept, late.planes().size());
}

TEST(SnapshotQueries, AnswersAlikeHoweverItWasMade) {
  const SnapshotQueries early(mapped_room().early, kDown);
  const SnapshotQueries late(mapped_room().late, kDown, &early);
  const SnapshotQueries anew(mapped_room().late, kDown);
  testing::Random random(71);
  for (int i = 0; i < 500; ++i) {
    NearestQuery nearest;
    nearest.point_m = random.in_cube(2.5);
    const auto near = late.nearest(nearest);
    ASSERT_EQ(near->size(), 1U);
    EXPECT_EQ(near->front().id, anew.nearest(nearest)->front().id);
    EXPECT_EQ(near->front().surface_distance_m, anew.nearest(nearest)->front().surface_distance_m);
    const Ray ray{random.in_cube(2.0), random.unit()};
    const RayHits hits = late.cast(std::span(&ray, 1))->front();
    const RayHits twin = anew.cast(std::span(&ray, 1))->front();
    ASSERT_EQ(hits.plane.has_value(), twin.plane.has_value());
    if (hits.plane) {
      EXPECT_EQ(hits.plane->range_m, twin.plane->range_m);
    }
    ASSERT_EQ(hits.cell.has_value(), twin.cell.has_value());
    if (hits.cell) {
      EXPECT_EQ(hits.cell->range_m, twin.cell->range_m);
    }
  }
}

TEST(SnapshotQueries, ARayInAMappedRoomMeetsTheWallAndItsCells) {
  const SnapshotQueries queries(mapped_room().late, kDown);
  const Ray ray{{-1.0, 0.0, 1.4}, {0.0, 1.0, -0.1}};
  const RayHits hits = queries.cast(std::span(&ray, 1))->front();
  const double range_m = 2.0 * std::hypot(1.0, 0.1);
  ASSERT_TRUE(hits.plane.has_value());
  EXPECT_NEAR(hits.plane->range_m, range_m, 0.003);
  EXPECT_FALSE(hits.plane->from_behind);
  ASSERT_TRUE(hits.cell.has_value());
  EXPECT_NEAR(hits.cell->range_m, range_m, 0.08);
  EXPECT_EQ(hits.cell->cell.plane_id, hits.plane->id);
}

TEST(SnapshotQueries, TheFloorplanOfAMappedRoomHasItsWallsAndItsFreeFloor) {
  const SnapshotQueries queries(mapped_room().late, kDown);
  const auto plan = queries.floorplan();
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  EXPECT_NEAR(plan->floor_height_m, 0.0, 0.005);
  EXPECT_GT(plan->axes.up.z(), 0.999);
  const auto holds = [&](const std::vector<Polygon>& polygons, double x, double y) {
    const Eigen::Vector2d p = plan->axes.to_plan({x, y, 0.0});
    bool odd = false;
    const auto cross = [&](const Ring& ring) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d& a = ring[i];
        const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
        if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
        odd ^= p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      }
    };
    for (const Polygon& polygon : polygons) {
      cross(polygon.outer);
      for (const Ring& hole : polygon.holes) cross(hole);
    }
    return odd;
  };
  for (const auto& [x, y] : {std::pair(2.55, 1.0), {2.55, -1.0}, {-2.55, 0.0}, {0.0, 2.05}, {0.0, -2.05}}) {
    EXPECT_TRUE(holds(plan->walls, x, y)) << x << " " << y;
    EXPECT_FALSE(holds(plan->free_floor, x, y)) << x << " " << y;
  }
  EXPECT_FALSE(holds(plan->walls, 1.55, 0.0)) << "the box is lower than where walls are cut";
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {-2.0, 1.5}, {-2.0, -1.5}, {1.2, 0.0}, {2.0, 1.2}, {2.0, -1.2}}) {
    EXPECT_TRUE(holds(plan->free_floor, x, y)) << x << " " << y;
  }
  EXPECT_FALSE(holds(plan->free_floor, 2.0, 0.0)) << "the box";
  EXPECT_FALSE(holds(plan->free_floor, 1.55, 0.4)) << "the box";
  // The room without the box is 19 m2; along walls and box the width of a cell or so is not free.
  EXPECT_LT(plan->free_area_m2, 19.0);
  EXPECT_GT(plan->free_area_m2, 16.5);
}

TEST(SnapshotQueries, PlanesWithoutBoundaryAreKnownByNameOnly) {
  PlaneRecord record = testing::record_of(3, Vector3d::Zero(), Vector3d::UnitZ(), 0.001, 0.001);
  Outline none;
  none.basis = basis_of(record.plane, record.centroid_m);
  const SnapshotQueries queries = testing::map_of({testing::described(record, none)}).queries();
  EXPECT_TRUE(queries.nearest(NearestQuery{})->empty());
  const Ray ray{{0.0, 0.0, 1.0}, -Vector3d::UnitZ()};
  EXPECT_FALSE(queries.cast(std::span(&ray, 1))->front().plane.has_value());
  EXPECT_TRUE(queries.region(RegionQuery{SphereRegion{Vector3d::Zero(), 1.0}, true, true, {}})->planes.empty());
  EXPECT_EQ(queries.plane(3)->fate, PlaneFate::kLives);
}

}  // namespace
}  // namespace planemap

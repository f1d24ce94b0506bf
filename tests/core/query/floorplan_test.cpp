#include "planemap/query/floorplan.hpp"

#include <gtest/gtest.h>

#include <planemap/block.hpp>
#include <planemap/query/snapshot_queries.hpp>

#include "query/clip.hpp"
#include "query/random_map.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;
using testing::described;
using testing::record_of;

/// A dense cell of 0.1 m with its centre at the middle of the cube that holds a place.
void add_cell(MapSnapshot::Parts& parts, const Vector3d& p_m) {
  const CellIndex index = (p_m / 0.1).array().floor().matrix().cast<int>();
  auto block = std::make_shared<Block>(block_of(index));
  block->cell(static_cast<std::size_t>(block->find_or_add(place_of(index)))).sums.count = 20.0;
  parts.blocks.push_back(std::move(block));
}

/// A floor of 4 m by 4 m about the origin with a hole of 1 m by 1 m in its middle; a wall x = 1.5 over all of it, seen
/// from the middle, with a doorway from y = 0.5 to 1.5 that is 2 m high; a table of 1 m by 1 m at 0.7 m; and cells.
testing::RandomMap made_up_flat() {
  const PlaneRecord floor = record_of(1, Vector3d::Zero(), Vector3d::UnitZ(), 0.001, 0.001);
  Outline floor_outline = testing::rectangle(floor, 4.0, 4.0);
  floor_outline.polygons[0].holes.push_back({{-0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}});
  const PlaneRecord wall = record_of(2, {1.5, 0.0, 1.25}, -Vector3d::UnitX(), 0.001, 0.001);
  Outline wall_outline = testing::rectangle(wall, 4.0, 2.5);
  // axis_u = up x normal = -y, axis_v = up: the doorway is cut out of the lower border.
  wall_outline.polygons[0].outer = {{-2.0, -1.25}, {-1.5, -1.25}, {-1.5, 0.75}, {-0.5, 0.75},
                                    {-0.5, -1.25}, {2.0, -1.25},  {2.0, 1.25},  {-2.0, 1.25}};
  const PlaneRecord table = record_of(3, {-1.5, 1.5, 0.7}, Vector3d::UnitZ(), 0.001, 0.001);
  MapSnapshot::Parts parts;
  parts.cell_size_m = 0.1;
  parts.density_threshold = 10;
  add_cell(parts, {-1.05, -1.05, 0.55});  // in the way
  add_cell(parts, {-1.05, -1.05, 1.25});  // above it
  add_cell(parts, {-1.55, -1.55, 0.05});  // on the floor
  add_cell(parts, {1.05, -1.55, 1.95});   // a lamp
  return testing::map_of(
      {described(floor, floor_outline, PlaneClass::kFloor), described(wall, wall_outline, PlaneClass::kWall),
       described(table, testing::rectangle(table, 1.0, 1.0), PlaneClass::kTable)},
      std::move(parts));
}

Floorplan plan_of(const testing::RandomMap& map, const FloorplanQuery& query = {}) {
  const SnapshotQueries queries(map.snapshot, map.planes, -2.0 * Vector3d::UnitZ());
  const auto plan = queries.floorplan(query);
  EXPECT_TRUE(plan.has_value()) << plan.error().message;
  return *plan;
}

TEST(Floorplan, WallsAreCutOverTheDoorwayAndDrawnInwards) {
  const Floorplan plan = plan_of(made_up_flat());
  EXPECT_NEAR(plan.floor_height_m, 0.0, 1e-12);
  EXPECT_TRUE(plan.axes.up.isApprox(Vector3d::UnitZ()));
  ASSERT_EQ(plan.walls.size(), 2U);  // largest first
  EXPECT_NEAR(area_m2(std::span(&plan.walls[0], 1)), 0.1 * 2.5, 1e-3);
  EXPECT_NEAR(area_m2(std::span(&plan.walls[1], 1)), 0.1 * 0.5, 1e-3);
  for (const Polygon& wall : plan.walls) {
    for (const Eigen::Vector2d& p : wall.outer) {
      const Vector3d p_m = p.x() * plan.axes.axis_x + p.y() * plan.axes.axis_y;
      EXPECT_GE(p_m.x(), 1.499);
      EXPECT_LE(p_m.x(), 1.601);
      EXPECT_TRUE(p_m.y() < 0.501 || p_m.y() > 1.499);
    }
  }
  FloorplanQuery over_the_door;
  over_the_door.cut_low_m = 2.1;
  over_the_door.cut_high_m = 2.4;
  EXPECT_EQ(plan_of(made_up_flat(), over_the_door).walls.size(), 1U);
}

TEST(Floorplan, FloorIsFreeWhereNothingStandsOnIt) {
  const Floorplan plan = plan_of(made_up_flat());
  EXPECT_NEAR(area_m2(plan.floor), 15.0, 1e-3);
  ASSERT_EQ(plan.floor.size(), 1U);
  EXPECT_EQ(plan.floor[0].holes.size(), 1U);
  // Less the walls' strips and one column of cells.
  EXPECT_NEAR(plan.free_area_m2, 15.0 - 0.1 * 3.0 - 0.01, 2e-3);
  ASSERT_EQ(plan.free_floor.size(), 1U);
  EXPECT_EQ(plan.free_floor[0].holes.size(), 2U);  // its own and the column; the walls are bays of the border
  FloorplanQuery tall;
  tall.clear_low_m = 0.02;
  tall.clear_high_m = 2.2;
  EXPECT_NEAR(plan_of(made_up_flat(), tall).free_area_m2, 15.0 - 0.1 * 3.0 - 0.03, 2e-3);
}

TEST(Floorplan, TheFilterIsForWallsAndFloors) {
  FloorplanQuery query;
  query.filter.min_area_m2 = 12.0;  // the wall has 10 m2
  const Floorplan plan = plan_of(made_up_flat(), query);
  EXPECT_TRUE(plan.walls.empty());
  EXPECT_NEAR(plan.free_area_m2, 15.0 - 0.01, 2e-3);
}

}  // namespace
}  // namespace planemap

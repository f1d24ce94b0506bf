#include "planemap/assignment.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "assignment_twin.hpp"
#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::commit;

TEST(Assigner, RefusesAnInstructionSetThatIsNotThere) {
  CoreConfig core;
  core.simd = is_supported(SimdTarget::kNeon) ? SimdTarget::kAvx2 : SimdTarget::kNeon;
  EXPECT_THROW(Assigner(core, SensorConfig{}, GridConfig{}), std::invalid_argument);
  EXPECT_TRUE(is_supported(SimdTarget::kScalar));
}

PointScan points(std::vector<float> xyz_m, std::vector<float> sigma_m = {}) {
  PointScan scan;
  scan.utime = 1;
  scan.xyz_m = std::move(xyz_m);
  scan.sigma_m = std::move(sigma_m);
  return scan;
}

GridConfig unit_cells() {
  GridConfig config;
  config.cell_size_m = 1.0;
  config.clamp_centres = false;
  return config;
}

TEST(Assigner, AnEmptyOwnCellTakesItsPoint) {
  UncertainGrid grid(1.0);
  Assigner assigner(CoreConfig{}, SensorConfig{}, unit_cells());
  const PointCounts counts = assigner.assign(grid, points({0.5F, 0.5F, 1.5F}), Isometry3d::Identity());
  commit(grid, assigner);
  EXPECT_EQ(counts.mapped, 1U);
  ASSERT_EQ(assigner.changes().size(), 1U);
  EXPECT_EQ(grid.index_of(assigner.changes()[0].cell), CellIndex(0, 0, 1));
}

TEST(Assigner, ThePointGoesToTheCellWithTheSmallestExpectedDistanceNotToItsOwn) {
  UncertainGrid grid(1.0);
  Assigner assigner(CoreConfig{}, SensorConfig{}, unit_cells());
  // Virtual centres (0.1, 0.5, 1.5) and (1.05, 0.5, 1.5); the next point, at x = 0.9, lies in the first one's cell.
  assigner.assign(grid, points({0.1F, 0.5F, 1.5F, 1.05F, 0.5F, 1.5F}), Isometry3d::Identity());
  commit(grid, assigner);
  assigner.assign(grid, points({0.9F, 0.5F, 1.5F}), Isometry3d::Identity());
  commit(grid, assigner);
  ASSERT_EQ(assigner.changes().size(), 1U);
  EXPECT_EQ(grid.index_of(assigner.changes()[0].cell), CellIndex(1, 0, 1));
}

TEST(Assigner, TheErrorOfACentreKeepsPointsAway) {
  // As above, but the second centre is uncertain: |0.9 - 1.05|^2 + S_s/n^2 = 0.0225 + 3 > |0.9 - 0.1|^2 = 0.64 + 3e-6.
  UncertainGrid grid(1.0);
  Assigner assigner(CoreConfig{}, SensorConfig{}, unit_cells());
  assigner.assign(grid, points({0.1F, 0.5F, 1.5F, 1.05F, 0.5F, 1.5F}, {0.001F, 0.001F, 0.001F, 1.0F, 1.0F, 1.0F}),
                  Isometry3d::Identity());
  commit(grid, assigner);
  assigner.assign(grid, points({0.9F, 0.5F, 1.5F}, {0.0F, 0.0F, 0.0F}), Isometry3d::Identity());
  commit(grid, assigner);
  ASSERT_EQ(assigner.changes().size(), 1U);
  EXPECT_EQ(grid.index_of(assigner.changes()[0].cell), CellIndex(0, 0, 1));
}

TEST(Assigner, StatisticsOfDefinition1ByHand) {
  UncertainGrid grid(1.0);
  Assigner assigner(CoreConfig{}, SensorConfig{}, unit_cells());
  assigner.assign(grid, points({0.5F, 0.5F, 1.5F, 0.75F, 0.25F, 1.5F}, {0.1F, 0.2F, 0.3F, 0.1F, 0.2F, 0.3F}),
                  Isometry3d::Identity());
  commit(grid, assigner);
  const CellSums& sums = grid.cell(*grid.find({0, 0, 1})).sums;
  EXPECT_DOUBLE_EQ(sums.count, 2.0);                                                     // d(u)
  EXPECT_TRUE(sums.first_m.isApprox(Vector3d(0.25, -0.25, 0.0), 1e-12));                 // L, about (0.5, 0.5, 1.5)
  EXPECT_NEAR(sums.square_m2.x(), 0.0625, 1e-7);                                         // S
  EXPECT_TRUE(sums.error_m2.cast<double>().isApprox(Vector3d(0.02, 0.08, 0.18), 1e-6));  // S_s
  EXPECT_LT(sums.view.z(), 0.0F);                                                        // the sensor is at the origin
}

TEST(Assigner, EveryPointIsAccountedFor) {
  UncertainGrid grid(1.0);
  Assigner assigner(CoreConfig{}, SensorConfig{}, unit_cells());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const PointCounts counts =
      assigner.assign(grid, points({0, 0, 1, nan, 0, 1, 0, 0, 100, 0, 0, 2}, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, -1, 1}),
                      Isometry3d::Identity());
  EXPECT_EQ(counts, (PointCounts{4, 1, 1, 1, 1}));
}

TEST(Assigner, DepthImagesWithoutAnyReturnChangeNothing) {
  DepthScan scan;
  scan.intrinsics = {4, 2, 5.0, 5.0, 2.0, 1.0};
  scan.depth = {0, 65535, 0, 65535, 1, 20000, 0, 0};
  UncertainGrid grid(0.08);
  Assigner assigner(CoreConfig{}, SensorConfig{}, GridConfig{});
  const PointCounts counts = assigner.assign(grid, scan, Isometry3d::Identity());
  EXPECT_EQ(counts, (PointCounts{8, 0, 6, 2, 0}));
  EXPECT_TRUE(assigner.changes().empty());
  EXPECT_EQ(grid.cell_count(), 0U);
}

TEST(Assigner, APoseOutOfThisWorldIsCountedNotStored) {
  UncertainGrid grid(0.08);
  Assigner assigner(CoreConfig{}, SensorConfig{}, GridConfig{});
  Isometry3d T = Isometry3d::Identity();
  T.translation().x() = 1e300;
  const PointCounts counts = assigner.assign(grid, points({0, 0, 1}), T);
  EXPECT_EQ(counts, (PointCounts{1, 0, 0, 1, 0}));
  EXPECT_EQ(grid.cell_count(), 0U);
}

TEST(Assigner, TheFarSideOfAThinWallAttractsNoPoints) {
  GridConfig config = unit_cells();
  config.view_side = true;
  UncertainGrid grid(1.0);
  Assigner assigner(CoreConfig{}, SensorConfig{}, config);
  // One face, x = 0.1, seen from x < 0; in the next cell the other face, x = 1.05, seen from x > 1.
  Isometry3d from_left = testing::looking({-2.0, 0.5, 0.5}, {0.0, 0.5, 0.5});
  Isometry3d from_right = testing::looking({4.0, 0.5, 0.5}, {0.0, 0.5, 0.5});
  const auto at = [](const Isometry3d& T, double x) {
    const Eigen::Vector3f p = (T.inverse() * Vector3d(x, 0.5, 0.5)).cast<float>();
    return points({p.x(), p.y(), p.z()});
  };
  assigner.assign(grid, at(from_left, 0.1), from_left);
  commit(grid, assigner);
  assigner.assign(grid, at(from_right, 1.05), from_right);
  commit(grid, assigner);
  assigner.assign(grid, at(from_left, 0.9), from_left);
  commit(grid, assigner);
  EXPECT_DOUBLE_EQ(grid.cell(*grid.find({0, 0, 0})).sums.count, 2.0);
  EXPECT_DOUBLE_EQ(grid.cell(*grid.find({1, 0, 0})).sums.count, 1.0);
}

}  // namespace
}  // namespace planemap

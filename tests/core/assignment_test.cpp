#include "planemap/assignment.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "planemap/expected_distance.hpp"
#include "planemap/scan_points.hpp"
#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Key = std::array<int, 3>;

Key key_of(const CellIndex& index) {
  return {index.x(), index.y(), index.z()};
}

/// The assignment as it is written down, without blocks, candidates or runs: for each point, Eq. 7 for the own cell and
/// the 26 around it with the centres of before the scan; an own cell without points takes the point.
class NaiveGrid {
 public:
  explicit NaiveGrid(double cell_size_m, bool clamp) : size_m_(cell_size_m), clamp_(clamp) {}

  void assign(const DepthScan& scan, const Isometry3d& T_world_sensor) {
    const std::map<Key, CellSums> frozen = cells_;
    for_each_point(scan, T_world_sensor, SensorConfig{}, [&](const UncertainPoint& point) {
      const Vector3d variance = rotate_variances(T_world_sensor.linear(), point.variance_sensor_m2);
      const CellIndex own = (point.p_world_m.array() / size_m_).floor().cast<int>();
      const CellIndex winner = frozen.count(key_of(own)) == 0 ? own : nearest(frozen, own, point.p_world_m, variance);
      CellSums& cell = cells_[key_of(winner)];
      const Vector3d q = point.p_world_m - centre_m(winner);
      cell.points.add(Moments{1.0, q, Symmetric3::outer(q)});
      cell.error_m2 += variance;
    });
  }
  const std::map<Key, CellSums>& cells() const { return cells_; }

 private:
  Vector3d centre_m(const CellIndex& index) const { return (index.cast<double>().array() + 0.5) * size_m_; }

  CellIndex nearest(const std::map<Key, CellSums>& frozen, const CellIndex& own, const Vector3d& p,
                    const Vector3d& variance) const {
    CellIndex best = own;
    double least = std::numeric_limits<double>::infinity();
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const CellIndex index = own + CellIndex(x, y, z);
          const auto found = frozen.find(key_of(index));
          if (found == frozen.end()) continue;
          CentreStatistics u{found->second.count(), found->second.points.first, found->second.error_m2};
          if (clamp_) {
            const double half = 0.5 * size_m_ * u.count;
            u.linear = u.linear.cwiseMax(-half).cwiseMin(half);
          }
          u.linear += u.count * centre_m(index);
          const double distance = expected_squared_distance(p, variance, u);
          if (distance < least) {
            least = distance;
            best = index;
          }
        }
      }
    }
    return best;
  }

  double size_m_;
  bool clamp_;
  std::map<Key, CellSums> cells_;
};

/// Puts the changes of a scan into the grid, as the mapper does.
void commit(UncertainGrid& grid, Assigner& assigner) {
  for (const CellChange& change : assigner.changes()) grid.writable(change.cell).sums.add(change.added);
  assigner.finish(grid);
}

std::vector<testing::Wall> corner() {
  return {
      {Vector3d(-1, 0.2, 0).normalized(), 2.1}, {Vector3d(0.1, 1, 0.05).normalized(), 1.3}, {Vector3d::UnitZ(), 0.9}};
}

class AssignerTwin : public ::testing::TestWithParam<bool> {};

TEST_P(AssignerTwin, AgreesWithTheEquationsCellByCell) {
  GridConfig config;
  config.clamp_centres = GetParam();
  config.view_side = false;
  UncertainGrid grid(config.cell_size_m);
  Assigner assigner(SensorConfig{}, config);
  NaiveGrid naive(config.cell_size_m, config.clamp_centres);
  for (std::uint64_t i = 0; i < 4; ++i) {
    const Isometry3d T = testing::looking({-1.0, 0.3, 0.4}, {1.5, 0.2 - 0.3 * static_cast<double>(i), -0.1});
    const DepthScan scan = testing::render(corner(), T, i, 1.0, 160, 120);
    assigner.assign(grid, scan, T);
    commit(grid, assigner);
    naive.assign(scan, T);
  }
  ASSERT_GT(naive.cells().size(), 500U);
  std::size_t with_points = 0;
  grid.for_each_cell([&](CellRef ref) {
    const CellSums& sums = grid.cell(ref).sums;
    EXPECT_EQ(grid.cell(ref).working, Cell::kNotWorking);
    if (sums.count() <= 0.0) return;
    ++with_points;
    const auto twin = naive.cells().find(key_of(grid.index_of(ref)));
    ASSERT_NE(twin, naive.cells().end());
    EXPECT_EQ(sums.count(), twin->second.count());
    EXPECT_TRUE(sums.points.first.isApprox(twin->second.points.first, 1e-9));
    EXPECT_TRUE(sums.points.second.matrix().isApprox(twin->second.points.second.matrix(), 1e-9));
    EXPECT_TRUE(sums.error_m2.isApprox(twin->second.error_m2, 1e-9));
  });
  EXPECT_EQ(with_points, naive.cells().size());
}

INSTANTIATE_TEST_SUITE_P(Centres, AssignerTwin, ::testing::Bool(),
                         [](const auto& param) { return param.param ? "Clamped" : "Free"; });

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
  Assigner assigner(SensorConfig{}, unit_cells());
  const PointCounts counts = assigner.assign(grid, points({0.5F, 0.5F, 1.5F}), Isometry3d::Identity());
  commit(grid, assigner);
  EXPECT_EQ(counts.mapped, 1U);
  ASSERT_EQ(assigner.changes().size(), 1U);
  EXPECT_EQ(grid.index_of(assigner.changes()[0].cell), CellIndex(0, 0, 1));
}

TEST(Assigner, ThePointGoesToTheCellWithTheSmallestExpectedDistanceNotToItsOwn) {
  UncertainGrid grid(1.0);
  Assigner assigner(SensorConfig{}, unit_cells());
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
  Assigner assigner(SensorConfig{}, unit_cells());
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
  Assigner assigner(SensorConfig{}, unit_cells());
  assigner.assign(grid, points({0.5F, 0.5F, 1.5F, 0.75F, 0.25F, 1.5F}, {0.1F, 0.2F, 0.3F, 0.1F, 0.2F, 0.3F}),
                  Isometry3d::Identity());
  commit(grid, assigner);
  const CellSums& sums = grid.cell(*grid.find({0, 0, 1})).sums;
  EXPECT_DOUBLE_EQ(sums.count(), 2.0);                                         // d(u)
  EXPECT_TRUE(sums.points.first.isApprox(Vector3d(0.25, -0.25, 0.0), 1e-12));  // L, about (0.5, 0.5, 1.5)
  EXPECT_NEAR(sums.points.second.e[0], 0.0625, 1e-12);                         // S
  EXPECT_NEAR(sums.points.second.e[1], -0.0625, 1e-12);                        // and its cross term
  EXPECT_TRUE(sums.error_m2.isApprox(Vector3d(0.02, 0.08, 0.18), 1e-6));       // S_s
  EXPECT_LT(sums.view.z(), 0.0F);                                              // the sensor is at the origin
}

TEST(Assigner, EveryPointIsAccountedFor) {
  UncertainGrid grid(1.0);
  Assigner assigner(SensorConfig{}, unit_cells());
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
  Assigner assigner(SensorConfig{}, GridConfig{});
  const PointCounts counts = assigner.assign(grid, scan, Isometry3d::Identity());
  EXPECT_EQ(counts, (PointCounts{8, 0, 6, 2, 0}));
  EXPECT_TRUE(assigner.changes().empty());
  EXPECT_EQ(grid.cell_count(), 0U);
}

TEST(Assigner, APoseOutOfThisWorldIsCountedNotStored) {
  UncertainGrid grid(0.08);
  Assigner assigner(SensorConfig{}, GridConfig{});
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
  Assigner assigner(SensorConfig{}, config);
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
  EXPECT_DOUBLE_EQ(grid.cell(*grid.find({0, 0, 0})).sums.count(), 2.0);
  EXPECT_DOUBLE_EQ(grid.cell(*grid.find({1, 0, 0})).sums.count(), 1.0);
}

}  // namespace
}  // namespace planemap

#include "planemap/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "commit.hpp"
#include "planemap/expected_distance.hpp"
#include "rooms.hpp"
#include "scan_points.hpp"

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Key = std::array<int, 3>;

Key key_of(const CellIndex& index) {
  return {index.x(), index.y(), index.z()};
}

/// The assignment as it is written down, without blocks, runs or vectors: for each point, Eq. 7 for the own cell and
/// the 26 around it with the centres of before the scan; an own cell without points takes the point. In doubles, so
/// points that lie within a millionth of a cell of a border between two cells may go either way.
class NaiveGrid {
 public:
  NaiveGrid(double cell_size_m, bool clamp) : size_m_(cell_size_m), clamp_(clamp) {}

  /// What the scan adds to each cell. `ties` gets the points that may be counted elsewhere, for each cell that may gain
  /// or lose one.
  template <class ScanType>
  std::map<Key, ScanSums> assign(const UncertainGrid& grid, const ScanType& scan, const Isometry3d& T_world_sensor,
                                 std::map<Key, int>& ties) const {
    std::map<Key, ScanSums> added;
    testing::for_each_point(scan, T_world_sensor, SensorConfig{}, [&](const testing::UncertainPoint& point) {
      const Vector3d variance = rotate_variances(T_world_sensor.linear(), point.variance_sensor_m2);
      const CellIndex own = (point.p_world_m.array() / size_m_).floor().cast<int>();
      std::set<Key> rivals;
      const CellIndex winner = takes(grid, own, point.p_world_m, variance, rivals);
      note_neighbouring_owns(grid, own, point.p_world_m, variance, rivals);
      rivals.insert(key_of(winner));
      if (rivals.size() > 1) {
        for (const Key& rival : rivals) ++ties[rival];
      }
      ScanSums& cell = added[key_of(winner)];
      const Vector3d q = point.p_world_m - centre_m(winner);
      cell.points.add(Moments{1.0, q, Symmetric3::outer(q)});
      cell.error_m2 += variance;
    });
    return added;
  }

 private:
  static constexpr double kTie = 2e-5;  // cells; what floats may lose between the sensor and a cell 60 cells away

  Vector3d centre_m(const CellIndex& index) const { return (index.cast<double>().array() + 0.5) * size_m_; }

  /// A point on the border of two cells may be taken to lie in either.
  void note_neighbouring_owns(const UncertainGrid& grid, const CellIndex& own, const Vector3d& p,
                              const Vector3d& variance, std::set<Key>& rivals) const {
    const Vector3d place = p / size_m_ - own.cast<double>();
    for (int axis = 0; axis < 3; ++axis) {
      const int side = place(axis) < kTie ? -1 : (place(axis) > 1.0 - kTie ? 1 : 0);
      if (side == 0) continue;
      rivals.insert(key_of(takes(grid, own + side * CellIndex::Unit(axis), p, variance, rivals)));
    }
  }

  CellIndex takes(const UncertainGrid& grid, const CellIndex& own, const Vector3d& p, const Vector3d& variance,
                  std::set<Key>& rivals) const {
    std::vector<std::pair<double, CellIndex>> distances;
    bool own_has_points = false;
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const CellIndex index = own + CellIndex(x, y, z);
          const auto found = grid.find(index);
          if (!found || grid.cell(*found).sums.count <= 0.0) continue;
          own_has_points = own_has_points || index == own;
          const CellSums& sums = grid.cell(*found).sums;
          CentreStatistics u{sums.count, sums.first_m, sums.error_m2.cast<double>()};
          if (clamp_) {
            const double half = 0.5 * size_m_ * u.count;
            u.linear = u.linear.cwiseMax(-half).cwiseMin(half);
          }
          u.linear += u.count * centre_m(index);
          distances.emplace_back(expected_squared_distance(p, variance, u), index);
        }
      }
    }
    if (!own_has_points) return own;
    const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
    const auto best = *std::min_element(distances.begin(), distances.end(), less);
    for (const auto& [distance, index] : distances) {
      if (distance - best.first < kTie * size_m_ * size_m_) rivals.insert(key_of(index));
    }
    return best.second;
  }

  double size_m_;
  bool clamp_;
};

/// Puts the changes of a scan into the grid, as the mapper does.
void commit(UncertainGrid& grid, Assigner& assigner) {
  testing::commit(grid, assigner.changes());
  assigner.finish(grid);
}

/// The changes must be the twin's, but for ties, to what floats leave of the sums.
void expect_same(const UncertainGrid& grid, const std::vector<CellChange>& changes, std::map<Key, ScanSums> expected,
                 const std::map<Key, int>& ties) {
  const auto ties_of = [&](const Key& key) {
    const auto found = ties.find(key);
    return found == ties.end() ? 0 : found->second;
  };
  for (const CellChange& change : changes) {
    const Key key = key_of(grid.index_of(change.cell));
    const ScanSums twin = expected[key];
    expected.erase(key);
    const double count = change.added.count();
    ASSERT_LE(std::abs(count - twin.count()), ties_of(key)) << key[0] << " " << key[1] << " " << key[2];
    if (ties_of(key) > 0) continue;
    // Sums of n numbers of up to a cell's size, or its square: a few digits of a float's seven are left to rounding.
    const double size_m = grid.cell_size_m();
    EXPECT_LT((change.added.points.first - twin.points.first).cwiseAbs().maxCoeff(), 2e-5 * size_m * count);
    EXPECT_LT((change.added.points.second.matrix() - twin.points.second.matrix()).cwiseAbs().maxCoeff(),
              2e-5 * size_m * size_m * count);
    EXPECT_TRUE(change.added.error_m2.isApprox(twin.error_m2, 1e-5));
  }
  for (const auto& [key, sums] : expected) EXPECT_LE(sums.count(), ties_of(key));
}

std::vector<testing::Wall> corner() {
  return {
      {Vector3d(-1, 0.2, 0).normalized(), 2.1}, {Vector3d(0.1, 1, 0.05).normalized(), 1.3}, {Vector3d::UnitZ(), 0.9}};
}

/// The same points as a cloud, in another order of magnitude of rows.
PointScan cloud_of(const DepthScan& scan) {
  PointScan cloud;
  cloud.utime = scan.utime;
  const PinholeIntrinsics& k = scan.intrinsics;
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const auto z = static_cast<float>(scan.depth[static_cast<std::size_t>(v * k.width + u)] * scan.depth_scale_m);
      const double x = (u - k.cx) / k.fx;
      const double y = (v - k.cy) / k.fy;
      cloud.xyz_m.insert(cloud.xyz_m.end(), {static_cast<float>(x) * z, static_cast<float>(y) * z, z});
    }
  }
  return cloud;
}

struct TwinCase {
  bool clamp;
  SimdTarget simd;
  const char* name;
};

class AssignerTwin : public ::testing::TestWithParam<TwinCase> {
 protected:
  void SetUp() override {
    config_.clamp_centres = GetParam().clamp;
    config_.view_side = false;
  }

  /// Assigns the scans one after another and compares each with the twin.
  template <class MakeScan>
  void expect_agreement(int width, int height, MakeScan&& make_scan) {
    CoreConfig core;
    core.simd = GetParam().simd;
    UncertainGrid grid(config_.cell_size_m);
    Assigner assigner(core, SensorConfig{}, config_);
    const NaiveGrid naive(config_.cell_size_m, config_.clamp_centres);
    std::size_t tied_cells = 0;
    std::size_t cells = 0;
    for (std::uint64_t i = 0; i < 4; ++i) {
      const Isometry3d T = testing::looking({-1.0, 0.3, 0.4}, {1.5, 0.2 - 0.3 * static_cast<double>(i), -0.1});
      const auto scan = make_scan(testing::render(corner(), T, i, 1.0, width, height));
      std::map<Key, int> ties;
      const auto expected = naive.assign(grid, scan, T, ties);
      assigner.assign(grid, scan, T);
      ASSERT_NO_FATAL_FAILURE(expect_same(grid, assigner.changes(), expected, ties));
      commit(grid, assigner);
      tied_cells += ties.size();
      cells += expected.size();
    }
    EXPECT_GT(cells, 500U);
    EXPECT_LT(10 * tied_cells, cells) << "too many ties to prove anything";
    grid.for_each_cell([&](CellRef ref) { EXPECT_EQ(grid.cell(ref).working, Cell::kNotWorking); });
  }

  GridConfig config_;
};

TEST_P(AssignerTwin, AgreesWithTheEquationsCellByCell) {
  expect_agreement(160, 120, [](DepthScan scan) { return scan; });
}

TEST_P(AssignerTwin, AgreesOnRowsThatNoVectorDivides) {
  expect_agreement(347, 61, [](DepthScan scan) { return scan; });
}

TEST_P(AssignerTwin, AgreesOnPointClouds) {
  expect_agreement(161, 119, cloud_of);
}

/// Both readings on the best instruction set of this machine, one on each of the others that it has.
std::vector<TwinCase> twin_cases() {
  std::vector<TwinCase> cases = {{true, SimdTarget::kAuto, "ClampedAuto"}, {false, SimdTarget::kAuto, "FreeAuto"}};
  for (const TwinCase& other :
       {TwinCase{true, SimdTarget::kAvx2, "ClampedAvx2"}, TwinCase{true, SimdTarget::kAvx512, "ClampedAvx512"},
        TwinCase{true, SimdTarget::kSse4, "ClampedSse4"}, TwinCase{true, SimdTarget::kNeon, "ClampedNeon"},
        TwinCase{true, SimdTarget::kScalar, "ClampedScalar"}}) {
    if (is_supported(other.simd)) cases.push_back(other);
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(All, AssignerTwin, ::testing::ValuesIn(twin_cases()),
                         [](const auto& param) { return param.param.name; });

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

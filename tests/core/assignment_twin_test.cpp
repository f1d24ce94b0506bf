// The fast assignment beside the equations as they are written, cell by cell.

#include "assignment_twin.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

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
    const testing::NaiveGrid naive(config_.cell_size_m, config_.clamp_centres);
    std::size_t tied_cells = 0;
    std::size_t cells = 0;
    for (std::uint64_t i = 0; i < 4; ++i) {
      const Isometry3d T = testing::looking({-1.0, 0.3, 0.4}, {1.5, 0.2 - 0.3 * static_cast<double>(i), -0.1});
      const auto scan = make_scan(testing::render(corner(), T, i, 1.0, width, height));
      std::map<testing::Key, int> ties;
      const auto expected = naive.assign(grid, scan, T, ties);
      assigner.assign(grid, scan, T);
      ASSERT_NO_FATAL_FAILURE(testing::expect_same(grid, assigner.changes(), expected, ties));
      testing::commit(grid, assigner);
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

}  // namespace
}  // namespace planemap

#include "planemap/local_planes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "commit.hpp"
#include "planemap/cell_normals.hpp"
#include "planemap/mapper.hpp"
#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;

/// The steps of Fig. 3 up to the local planes, on one look at the walls.
struct OneScan {
  OneScan(const std::vector<testing::Wall>& walls, const Eigen::Isometry3d& T, const MapperConfig& config)
      : grid(config.grid.cell_size_m),
        assigner(config.core, config.sensor, config.grid),
        extractor(config.grid, config.normals, config.planes) {
    assigner.assign(grid, testing::render(walls, T, 1), T);
    NormalEstimator normals(config.normals);
    testing::commit(grid, assigner.changes());
    for (const CellChange& change : assigner.changes()) normals.refresh(grid, change.cell);
    Neighbourhoods neighbourhoods;
    neighbourhoods.gather(grid, assigner.changes());
    const auto found = extractor.extract(grid, assigner.changes(), neighbourhoods);
    planes.assign(found.begin(), found.end());
    std::sort(planes.begin(), planes.end(),
              [](const LocalPlane& a, const LocalPlane& b) { return a.cells.size() > b.cells.size(); });
  }

  UncertainGrid grid;
  Assigner assigner;
  LocalPlaneExtractor extractor;
  std::vector<LocalPlane> planes;
};

const std::vector<testing::Wall> kCorner = {{Vector3d(-1, 0.1, 0.05).normalized(), 2.2},
                                            {Vector3d(0.1, 1, -0.03).normalized(), 1.0}};

class LocalPlanes : public ::testing::TestWithParam<Preset> {};

TEST_P(LocalPlanes, ACornerGivesItsTwoWalls) {
  const OneScan scan(kCorner, testing::looking({0.3, 0.4, 0.0}, {2.0, -0.6, 0.0}), preset(GetParam()));
  ASSERT_GE(scan.planes.size(), 2U);
  for (const testing::Wall& wall : kCorner) {
    const double nearest = std::min(testing::degrees_between(scan.planes[0].fit.plane.normal(), wall.normal),
                                    testing::degrees_between(scan.planes[1].fit.plane.normal(), wall.normal));
    EXPECT_LT(nearest, GetParam() == Preset::kBest ? 0.3 : 5.0);
  }
}

TEST_P(LocalPlanes, NoCellIsInTwoPlanes) {
  const OneScan scan(kCorner, testing::looking({0.3, 0.4, 0.0}, {2.0, -0.6, 0.0}), preset(GetParam()));
  std::vector<bool> taken(scan.assigner.changes().size());
  std::size_t cells = 0;
  for (const LocalPlane& plane : scan.planes) {
    for (const CellRef ref : plane.cells) {
      const std::uint32_t change = scan.grid.cell(ref).working;
      ASSERT_LT(change, taken.size());
      EXPECT_FALSE(taken[change]);
      taken[change] = true;
      ++cells;
    }
  }
  EXPECT_GT(cells, 200U);
}

INSTANTIATE_TEST_SUITE_P(Presets, LocalPlanes, ::testing::Values(Preset::kBest, Preset::kPaper),
                         [](const auto& param) { return param.param == Preset::kBest ? "Best" : "Paper"; });

TEST(LocalPlaneExtractor, OnlyDenseCellsAreTaken) {
  MapperConfig config = preset(Preset::kBest);
  config.grid.density_threshold = 100;
  const OneScan scan(kCorner, testing::looking({0.3, 0.4, 0.0}, {2.0, -0.6, 0.0}), config);
  ASSERT_FALSE(scan.planes.empty());
  for (const LocalPlane& plane : scan.planes) {
    for (const CellRef ref : plane.cells) EXPECT_GT(scan.grid.cell(ref).sums.count, 100.0);  // strictly
  }
}

TEST(LocalPlaneExtractor, CellsWithTooUncertainNormalsAreFiltered) {
  MapperConfig config = preset(Preset::kBest);
  config.normals.max_deviation_deg = 0.0;
  const OneScan scan(kCorner, testing::looking({0.3, 0.4, 0.0}, {2.0, -0.6, 0.0}), config);
  EXPECT_TRUE(scan.planes.empty());
}

bool upper(const Vector3d& p) {
  return p.z() > 0.0;
}
bool lower(const Vector3d& p) {
  return p.z() <= 0.0;
}

TEST(LocalPlaneExtractor, TheOffsetTestKeepsParallelSurfacesApart) {
  // Two parallel fronts, 10 cm apart: the paper's angle alone can't tell them apart where they touch.
  const std::vector<testing::Wall> step = {{-Vector3d::UnitX(), 1.5, lower}, {-Vector3d::UnitX(), 1.6, upper}};
  const OneScan scan(step, testing::looking({0.0, 0.03, 0.05}, {1.5, 0.03, 0.05}), preset(Preset::kBest));
  ASSERT_GE(scan.planes.size(), 2U);
  EXPECT_NEAR(std::min(scan.planes[0].fit.plane.d(), scan.planes[1].fit.plane.d()), 1.5, 0.002);
  EXPECT_NEAR(std::max(scan.planes[0].fit.plane.d(), scan.planes[1].fit.plane.d()), 1.6, 0.002);
}

}  // namespace
}  // namespace planemap

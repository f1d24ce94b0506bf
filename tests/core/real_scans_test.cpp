// The fast assignment beside the equations on scans of a real Kinect: its holes, edges and noise.

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <planemap/sources/open_folder.hpp>
#include <string>
#include <utility>

#include "assignment_twin.hpp"

namespace planemap {
namespace {

TEST(RealScans, AreAssignedAsTheEquationsSayCellByCell) {
  const char* data = std::getenv("PLANEMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set: no red kitchen";
  auto source = sources::open_folder(std::string(data) + "/redkitchen");
  ASSERT_TRUE(source.has_value()) << source.error().message;
  GridConfig config;
  config.view_side = false;
  UncertainGrid grid(config.cell_size_m);
  Assigner assigner(CoreConfig{}, SensorConfig{}, config);
  const testing::NaiveGrid naive(config.cell_size_m, config.clamp_centres);
  constexpr int kEvery = 20;
  constexpr int kCompared = 5;
  std::size_t points = 0;
  std::size_t tied_cells = 0;
  std::size_t cells = 0;
  for (int i = 0; i < kEvery * kCompared; ++i) {
    auto frame = (*source)->next();
    ASSERT_TRUE(frame.has_value());
    if (i % kEvery != 0) {
      assigner.assign(grid, Scan(std::move(frame->scan)), frame->T_world_sensor);
      testing::commit(grid, assigner);
      continue;
    }
    std::map<testing::Key, int> ties;
    const auto expected = naive.assign(grid, frame->scan, frame->T_world_sensor, ties);
    points += assigner.assign(grid, Scan(std::move(frame->scan)), frame->T_world_sensor).mapped;
    ASSERT_NO_FATAL_FAILURE(testing::expect_same(grid, assigner.changes(), expected, ties));
    testing::commit(grid, assigner);
    tied_cells += ties.size();
    cells += expected.size();
  }
  EXPECT_GT(points, 1'000'000U);
  EXPECT_LT(5 * tied_cells, cells) << "too many ties to prove anything";
}

}  // namespace
}  // namespace planemap

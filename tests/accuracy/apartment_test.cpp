// Rendered apartments, on seeds that nothing was tuned on.

#include <gtest/gtest.h>

#include <vector>

#include "scene_run.hpp"

namespace planemap::accuracy {
namespace {

Summary summary_of(const std::vector<std::uint64_t>& seeds) {
  std::vector<Run> runs;
  for (const std::uint64_t seed : seeds) {
    RunConfig config;
    config.seed = seed;
    runs.push_back(run_scene(config));
  }
  return summarise(runs);
}

TEST(Apartments, FiveTogetherAreMappedRight) {
  const Summary all = summary_of({1001, 1002, 1003, 1004, 1005});
  ASSERT_GE(all.surfaces, 100U);
  EXPECT_GE(all.correct_share(), 0.95) << all.correct << " of " << all.surfaces;
  EXPECT_LE(all.normal_mean_deg, 0.1);
  EXPECT_LE(all.normal_max_deg, 1.0);
  EXPECT_LE(all.offset_mean_m, 0.001);
  EXPECT_LE(all.noise, 1U);
  RecordProperty("correct", std::to_string(all.correct_share()));
  RecordProperty("normalMeanDeg", std::to_string(all.normal_mean_deg));
}

}  // namespace
}  // namespace planemap::accuracy

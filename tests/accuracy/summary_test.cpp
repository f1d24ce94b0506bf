// The scores' own test: what covariances that are wrong come to.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "scene_run.hpp"

namespace planemap::accuracy {
namespace {

using MapRun = Run;  // Run is another thing inside of a test

/// A run whose surfaces have these NEES, all correct.
Run run_with(const std::vector<double>& nees) {
  Run run;
  for (const double value : nees) {
    SurfaceScore surface;
    surface.seen_m2 = 1.0;
    surface.labelled_m2 = 0.5;
    surface.verdict = Verdict::kCorrect;
    surface.nees = value;
    run.score.surfaces.push_back(surface);
  }
  return run;
}

/// NEES of planes whose covariances are their errors' times a factor: chi squared of 3 degrees of freedom, divided by
/// it.
Summary summary_of_scaled(double covariance_scale) {
  std::mt19937_64 bits(7);
  std::chi_squared_distribution<double> chi_squared(3.0);
  std::vector<double> nees(2000);
  for (double& value : nees) value = chi_squared(bits) / covariance_scale;
  const Run run = run_with(nees);
  return summarise({&run, 1});
}

TEST(Summary, CountsAndSharesByHand) {
  std::vector<MapRun> runs = {run_with({0.1, 1.0, 3.0}), run_with({8.0, 100.0})};
  runs[0].score.surfaces[0].normal_error_deg = 0.5;
  runs[1].score.surfaces[1].offset_error_m = 0.01;
  runs[1].score.surfaces.push_back({});  // missed
  runs[1].score.noise = {4};
  runs[0].score.joined = 2;
  runs[0].ms_per_scan = 1.0;
  runs[1].ms_per_scan = 3.0;
  const Summary s = summarise(runs);
  EXPECT_EQ(s.surfaces, 6U);
  EXPECT_EQ(s.correct, 5U);
  EXPECT_EQ(s.missed, 1U);
  EXPECT_EQ(s.noise, 1U);
  EXPECT_EQ(s.joined, 2U);
  EXPECT_DOUBLE_EQ(s.labelled_share, 0.5);
  EXPECT_DOUBLE_EQ(s.normal_mean_deg, 0.1);
  EXPECT_DOUBLE_EQ(s.normal_max_deg, 0.5);
  EXPECT_DOUBLE_EQ(s.offset_mean_m, 0.002);
  EXPECT_DOUBLE_EQ(s.nees_median, 3.0);
  EXPECT_DOUBLE_EQ(s.nees_mean, 112.1 / 5.0);
  EXPECT_DOUBLE_EQ(s.nees_below, 0.6);
  EXPECT_DOUBLE_EQ(s.nees_within, 0.6) << "0.1 is below, 100 above the two-sided bounds";
  EXPECT_DOUBLE_EQ(s.ms_per_scan, 2.0);
}

TEST(Summary, CellNormalsAreComparedWithWhatTheyState) {
  MapRun run;
  const double rad_per_deg = std::numbers::pi / 180.0;
  for (int i = 1; i <= 100; ++i) {  // errors of 0.01, 0.02, ... 1 degree, all stated as 0.2
    run.score.cell_normals.push_back({0.01 * i * rad_per_deg, 0.2 * rad_per_deg, i <= 50});
  }
  const Summary s = summarise({&run, 1});
  EXPECT_EQ(s.cells.cells, 100U);
  EXPECT_NEAR(s.cells.mean_deg, 0.505, 1e-9);
  EXPECT_NEAR(s.cells.ratio_median, 2.55, 1e-9);
  EXPECT_NEAR(s.cells.ratio_p95, 4.8, 1e-9);
  EXPECT_NEAR(s.cells.within_1, 0.2, 0.011);
  EXPECT_NEAR(s.cells.within_3, 0.6, 0.011);
  EXPECT_EQ(s.inside_cells.cells, 50U);
  EXPECT_NEAR(s.inside_cells.mean_deg, 0.255, 1e-9);
}

TEST(NeesBounds, HoldForCovariancesThatAreRight) {
  const Summary right = summary_of_scaled(1.0);
  EXPECT_NEAR(right.nees_median, 2.37, 0.1);
  EXPECT_NEAR(right.nees_mean, 3.0, 0.2);
  EXPECT_NEAR(right.nees_within, 0.95, 0.015);
  EXPECT_TRUE(NeesBounds().hold(right));
}

TEST(NeesBounds, FailForCovariancesThatAreSixteenTimesTooLargeOrTooSmall) {
  for (const double scale : {16.0, 1.0 / 16.0}) {
    const Summary wrong = summary_of_scaled(scale);
    EXPECT_FALSE(NeesBounds().hold(wrong)) << scale;
    // Either bound alone would do: neither leans on the other.
    EXPECT_LT(wrong.nees_within, NeesBounds().least_within) << scale;
    EXPECT_TRUE(wrong.nees_median < NeesBounds().least_median || wrong.nees_median > NeesBounds().most_median) << scale;
  }
}

struct Wandering {
  double sigma_m;
  double sigma_deg;
  double sigma_rad;
};

class NeesBoundsOfMaps : public testing::TestWithParam<Wandering> {};

// A real map: poses wander, the mapper is told, and its covariances hold the bounds; scaled ones don't.
TEST_P(NeesBoundsOfMaps, TellRightCovariancesFromScaledOnes) {
  const Wandering& pose = GetParam();
  std::vector<MapRun> right;
  std::vector<MapRun> inflated;
  std::vector<MapRun> deflated;
  for (const std::uint64_t seed : {11, 12}) {
    RunConfig config;
    config.seed = seed;
    config.frames = 120;
    config.pose_sigma_m = pose.sigma_m;
    config.pose_sigma_deg = pose.sigma_deg;
    config.pose_correlation_s = 2.0;
    config.mapping.pose_error = {pose.sigma_m, pose.sigma_rad, 2.0};
    const MappedScene mapped = map_scene(config);
    const auto scored = [&mapped](double covariance_scale) {
      ScoreOptions options;
      options.covariance_scale = covariance_scale;
      return MapRun{score(*mapped.map, mapped.seen, options), mapped.ms_per_scan};
    };
    right.push_back(scored(1.0));
    inflated.push_back(scored(16.0));
    deflated.push_back(scored(1.0 / 16.0));
  }
  const Summary summary = summarise(right);
  ASSERT_GE(summary.correct, 40U);
  EXPECT_TRUE(NeesBounds().hold(summary)) << "median " << summary.nees_median << ", within " << summary.nees_within;
  EXPECT_NEAR(summarise(inflated).nees_median, summary.nees_median / 16.0, 1e-6 * summary.nees_median);
  EXPECT_NEAR(summarise(deflated).nees_median, summary.nees_median * 16.0, 1e-6 * summary.nees_median * 16.0);
  EXPECT_FALSE(NeesBounds().hold(summarise(inflated)));
  EXPECT_FALSE(NeesBounds().hold(summarise(deflated)));
}

INSTANTIATE_TEST_SUITE_P(NeesBounds, NeesBoundsOfMaps,
                         testing::Values(Wandering{0.002, 0.046, 0.0008}, Wandering{0.005, 0.1146, 0.002}));

}  // namespace
}  // namespace planemap::accuracy

// What the benchmarks say of their times.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench_report.hpp"
#include "common/quantile.hpp"
#include "scale/scale_report.hpp"

namespace planemap::benchmark {
namespace {

TEST(Quantile, IsAValueOfTheSortedOnes) {
  EXPECT_EQ(median({5.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(quantile({4.0, 1.0, 3.0, 2.0, 5.0}, 1.0), 5.0);
  EXPECT_EQ(quantile({4.0, 1.0, 3.0, 2.0, 5.0}, 0.0), 1.0);
  EXPECT_THROW(median({}), std::invalid_argument);
}

/// Three frames; the whole takes 6, 8 and 20 ms of 5, 7 and 8 own, the reference 4 of 2.
BenchReport report_of_three_frames() {
  BenchReport report;
  for (const auto& [ms, own_ms] : {std::pair(6.0, 5.0), std::pair(20.0, 8.0), std::pair(8.0, 7.0)}) {
    report.add({{"planemap", ms, own_ms}, {"planemap.assign", 3.0, 3.0}});
    report.add({{"reference", 4.0, 2.0}});
  }
  return report;
}

TEST(BenchReport, BoundsAreRatiosOfMediansAndLackWhatWasNotMeasured) {
  const BenchReport report = report_of_three_frames();
  const auto bounds = report.bounds();
  ASSERT_EQ(bounds.size(), 3U);  // there is no VoxelGrid and no SSE4
  EXPECT_EQ(std::string(bounds[0].name), "wholeToReference");
  EXPECT_DOUBLE_EQ(bounds[0].ratio, 2.0);
  EXPECT_DOUBLE_EQ(bounds[0].own_ratio, 3.5);
  EXPECT_EQ(std::string(bounds[1].name), "assignToReference");
  EXPECT_DOUBLE_EQ(bounds[1].ratio, 0.75);
  EXPECT_EQ(std::string(bounds[2].name), "p95ToMedian");
  EXPECT_THROW(report.median_ms("planemap.wear"), std::invalid_argument);
}

TEST(BenchReport, TableSaysWhatMissedItsBound) {
  BenchReport report = report_of_three_frames();
  EXPECT_EQ(report.bounds_table().find("missed"), std::string::npos);
  report.add({{"pclVoxelGrid", 8.0, 7.0}});
  EXPECT_NE(report.bounds_table().find("missed"), std::string::npos);
}

TEST(BenchReport, JsonHasTheKeysThatScriptsReadAndTheMachine) {
  const auto json = nlohmann::json::parse(report_of_three_frames().json(3, 1000));
  EXPECT_EQ(json.at("medianMs").at("planemap"), 8.0);
  EXPECT_EQ(json.at("medianMs").at("planemap.assign"), 3.0);
  EXPECT_EQ(json.at("p95Ms").at("reference"), 4.0);
  EXPECT_EQ(json.at("ownMedianMs").at("planemap"), 7.0);
  EXPECT_EQ(json.at("frames"), 3);
  for (const char* key : {"cpu", "cores", "load", "compiler", "flags", "buildType"}) {
    EXPECT_TRUE(json.at("machine").contains(key)) << key;
  }
  EXPECT_TRUE(json.at("versions").contains("octomap"));
}

ScaleWindow window_of(double area_m2, double with_twin_own_ms, double twin_own_ms) {
  ScaleWindow window;
  window.area_m2 = area_m2;
  window.cells = 1000;
  window.with_twin_own_ms = with_twin_own_ms;
  window.twin_own_ms = twin_own_ms;
  return window;
}

TEST(Scale, RatioIsThatOfTheLargestMaps) {
  std::vector<ScaleWindow> windows = {window_of(100.0, 10.0, 10.0), window_of(5000.0, 11.0, 10.0)};
  EXPECT_DOUBLE_EQ(scale_ratio(windows).ratio, 1.1) << "the last one's, while the map is not large";
  windows.push_back(window_of(9500.0, 24.0, 20.0));
  windows.push_back(window_of(10500.0, 28.0, 20.0));
  windows.push_back(window_of(11000.0, 0.0, 0.0));  // without a twin
  EXPECT_DOUBLE_EQ(scale_ratio(windows).ratio, 1.3);
  EXPECT_EQ(scale_ratio(windows).area_m2, 11000.0);
  EXPECT_EQ(scale_ratio({}).ratio, 0.0);
}

TEST(Scale, AShortRunHasItsWindowsAndAskersLearnTheSame) {
  ScaleConfig config;
  config.scans = 5;
  config.window = 2;
  config.shrink = 4;
  config.mapper = preset(Preset::kBest);
  std::size_t told = 0;
  const auto windows = run_scale(config, [&](const ScaleWindow&) { ++told; });
  ASSERT_EQ(windows.size(), 3U);
  EXPECT_EQ(told, 3U);
  EXPECT_EQ(windows.front().scans, 2U);
  EXPECT_EQ(windows.back().scans, 5U);
  EXPECT_GT(windows.back().area_m2, 10.0);
  EXPECT_GE(windows.back().cells, windows.front().cells);
  EXPECT_GT(windows.back().own_ms, 0.0);
  const auto json = nlohmann::json::parse(scale_json(windows));
  EXPECT_EQ(json.at("windows").size(), 3U);
  EXPECT_EQ(json.at("windows").back().at("scans"), 5);
  config.minutes = 1e-9;
  EXPECT_EQ(run_scale(config, [](const ScaleWindow&) {}).size(), 1U) << "time is up after the first window";
}

}  // namespace
}  // namespace planemap::benchmark

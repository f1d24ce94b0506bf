// What the soak makes of its readings: a leak must show, and what goes up and down must not.
#include "soak/soak_report.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "soak/trend.hpp"

namespace planemap::system_test {
namespace {

/// Ten minutes of a daemon that holds so much more each hour, beside what comes and goes in a tour of 30 s.
SoakResult ten_minutes(double leak_mb_per_hour) {
  SoakResult result;
  for (double at_s = 0.0; at_s < 600.0; at_s += 0.5) {
    const double tour_mb = 3.0 * std::sin(at_s / 30.0 * 6.283185);
    const double heap_b = 1e6 * (50.0 + tour_mb + leak_mb_per_hour * at_s / 3600.0);
    result.samples.push_back({at_s, heap_b + 2e7, heap_b, 100000, static_cast<std::int64_t>(30.0 * at_s)});
  }
  result.sent = 18000;
  result.counters = {{"scans.mapped", 18000}};
  result.visits = {{"grpc", 12}, {"lcm", 11}};
  result.daemon_exit_code = 0;
  return result;
}

SoakConfig ten_minutes_config() {
  SoakConfig config;
  config.minutes = 10.0;
  config.warm_up_minutes = 1.0;
  return config;
}

const SoakBound& bound(const std::vector<SoakBound>& bounds, const std::string& name) {
  for (const SoakBound& bound : bounds) {
    if (name == bound.name) return bound;
  }
  throw std::out_of_range(name);
}

TEST(SlopePerS, IsThatOfTheLineThroughThePoints) {
  EXPECT_DOUBLE_EQ(slope_per_s(std::array<Reading, 2>{{{1.0, 5.0}, {3.0, 9.0}}}), 2.0);
  // By hand: mean (2, 4); products (-2)(-3) + 0(2) + 2(1) = 8, squares 8.
  EXPECT_DOUBLE_EQ(slope_per_s(std::array<Reading, 3>{{{0.0, 1.0}, {2.0, 6.0}, {4.0, 5.0}}}), 1.0);
}

TEST(SlopePerS, NeedsTwoTimes) {
  EXPECT_THROW(slope_per_s({}), std::invalid_argument);
  EXPECT_THROW(slope_per_s(std::array<Reading, 2>{{{1.0, 5.0}, {1.0, 9.0}}}), std::invalid_argument);
}

TEST(SoakBounds, AreHeldWhereMemoryOnlyComesAndGoes) {
  for (const SoakBound& bound : soak_bounds(ten_minutes_config(), ten_minutes(0.0), {0.5})) {
    EXPECT_TRUE(bound.held()) << bound.name << " " << bound.value;
  }
}

TEST(SoakBounds, ShowALeak) {
  const auto bounds = soak_bounds(ten_minutes_config(), ten_minutes(12.0), {0.5});
  // 18 whole sines of 3 MB lie across the line: 6 A / (pi n) in 0.15 h.
  EXPECT_NEAR(bound(bounds, "heapMbPerHour").value, 12.0 - 6.0 * 3.0 / (3.141593 * 18.0) / 0.15, 0.05);
  EXPECT_NEAR(bound(bounds, "heapMbPerHour").most, 1.0 + 0.5 / 0.15, 1e-9);
  EXPECT_FALSE(bound(bounds, "heapMbPerHour").held());
  EXPECT_FALSE(bound(bounds, "residentMbPerHour").held());
}

TEST(SoakBounds, ShowWhatWasLostComplainedOfAndCrashed) {
  SoakResult result = ten_minutes(0.0);
  result.counters["scans.mapped"] -= 1;
  result.complaints = {"grpc: snapshot: planemapd is busy"};
  result.daemon_exit_code = 139;
  const auto bounds = soak_bounds(ten_minutes_config(), result, {0.5});
  EXPECT_FALSE(bound(bounds, "notMapped").held());
  EXPECT_FALSE(bound(bounds, "complaints").held());
  EXPECT_FALSE(bound(bounds, "exitCode").held());
}

TEST(SoakBounds, LetAShareOfTheScansBeLostWhereThatIsAskedFor) {
  SoakResult result = ten_minutes(0.0);
  result.counters["scans.mapped"] -= 180;
  EXPECT_TRUE(bound(soak_bounds(ten_minutes_config(), result, {0.5, 0.01}), "notMapped").held());
  EXPECT_FALSE(bound(soak_bounds(ten_minutes_config(), result, {0.5, 0.0099}), "notMapped").held());
}

TEST(SoakReport, IsReadableAndJson) {
  SoakResult result = ten_minutes(0.0);
  result.complaints = {"grpc: snapshot: planemapd is busy"};
  const std::string table = soak_table(ten_minutes_config(), result, {0.5});
  EXPECT_NE(table.find("10.0 minutes, the first 1.0 to warm up; 18000 scans sent, 100000 cells"), std::string::npos)
      << table;
  EXPECT_NE(table.find("clients: 12 grpc 11 lcm"), std::string::npos) << table;
  EXPECT_NE(table.find("grpc: snapshot: planemapd is busy"), std::string::npos) << table;
  const auto json = nlohmann::json::parse(soak_json(ten_minutes_config(), result, {0.5}));
  EXPECT_EQ(json.at("bounds").at("notMapped").at("held"), true);
  EXPECT_EQ(json.at("bounds").at("complaints").at("held"), false);
  EXPECT_EQ(json.at("samples").size(), 1200U);
}

}  // namespace
}  // namespace planemap::system_test

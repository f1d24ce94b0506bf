// What planemap-latency makes of what it heard.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "latency/latency_meter.hpp"
#include "latency/latency_report.hpp"

namespace planemap::benchmark {
namespace {

TEST(LatencyMeter, CountsFromTheLaterOfScanAndPoseToTheDelta) {
  LatencyMeter meter;
  meter.scan_arrived(1000, 50'000);
  meter.pose_arrived(900, 10'000);
  meter.pose_arrived(1100, 53'000);  // after its scan
  meter.page_arrived(1000, 7, 0, 1, 60'500);
  meter.scan_arrived(2000, 80'000);
  meter.pose_arrived(2100, 79'000);  // before its scan
  meter.page_arrived(2000, 8, 0, 1, 90'000);
  const auto scans = meter.latencies();
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_DOUBLE_EQ(scans[0].wait_ms, 3.0);
  EXPECT_DOUBLE_EQ(scans[0].delta_ms, 7.5);
  EXPECT_DOUBLE_EQ(scans[1].wait_ms, 0.0);
  EXPECT_DOUBLE_EQ(scans[1].delta_ms, 10.0);
  EXPECT_TRUE(scans[0].alone);
  EXPECT_TRUE(meter.is_up_to_date());
}

TEST(LatencyMeter, AScanWithoutADeltaOfItsOwnIsInTheNextOne) {
  LatencyMeter meter;
  meter.scan_arrived(1000, 0);
  meter.scan_arrived(2000, 30'000);
  meter.scan_arrived(3000, 60'000);
  for (const int utime : {1000, 2000, 3000}) meter.pose_arrived(utime, 0);
  meter.page_arrived(2000, 7, 0, 1, 40'000);
  EXPECT_FALSE(meter.is_up_to_date());
  const auto scans = meter.latencies();
  ASSERT_EQ(scans.size(), 2U) << "nothing is known of the last one yet";
  EXPECT_DOUBLE_EQ(scans[0].delta_ms, 40.0);
  EXPECT_FALSE(scans[0].alone);
  EXPECT_DOUBLE_EQ(scans[1].delta_ms, 10.0);
  EXPECT_TRUE(scans[1].alone);
}

TEST(LatencyMeter, ADeltaHasArrivedWithItsLastPage) {
  LatencyMeter meter;
  meter.scan_arrived(1000, 0);
  meter.pose_arrived(1000, 0);
  meter.page_arrived(1000, 7, 1, 3, 5'000);
  meter.page_arrived(1000, 7, 1, 3, 6'000);  // the same once more
  meter.page_arrived(1000, 7, 0, 3, 7'000);
  EXPECT_EQ(meter.deltas(), 0U);
  EXPECT_TRUE(meter.latencies().empty());
  meter.page_arrived(1000, 7, 2, 3, 9'000);
  EXPECT_EQ(meter.deltas(), 1U);
  ASSERT_EQ(meter.latencies().size(), 1U);
  EXPECT_DOUBLE_EQ(meter.latencies()[0].delta_ms, 9.0);
}

TEST(LatencyMeter, AScanWithoutAPoseAfterItIsNotMeasured) {
  LatencyMeter meter;
  meter.scan_arrived(1000, 0);
  meter.pose_arrived(999, 0);
  meter.page_arrived(1000, 7, 0, 1, 5'000);
  EXPECT_TRUE(meter.latencies().empty());
}

/// 100 scans that took 1 to 100 ms.
LatencyResult result_of_hundred_scans() {
  LatencyResult result;
  result.sent = result.heard = 100;
  result.counters = {{"scans.received", 100}, {"scans.mapped", 100}};
  result.scans.reserve(100);
  for (int i = 1; i <= 100; ++i) result.scans.push_back({i, 0.0, static_cast<double>(i), true});
  return result;
}

TEST(LatencyReport, SaysWhatMissedItsBound) {
  LatencyResult result = result_of_hundred_scans();
  auto bounds = latency_bounds(result);
  ASSERT_EQ(bounds.size(), 3U);
  EXPECT_DOUBLE_EQ(bounds[0].value, 99.0);
  EXPECT_FALSE(bounds[0].held());
  EXPECT_TRUE(bounds[1].held());
  EXPECT_TRUE(bounds[2].held());
  EXPECT_NE(latency_table({}, result).find("missed"), std::string::npos);
  for (ScanLatency& scan : result.scans) scan.delta_ms *= 0.1;
  EXPECT_EQ(latency_table({}, result).find("missed"), std::string::npos);
  result.counters["scans.mapped"] = 98;
  result.counters["scans.dropped.queue_full"] = 2;
  result.scans.pop_back();
  bounds = latency_bounds(result);
  EXPECT_DOUBLE_EQ(bounds[1].value, 2.0);
  EXPECT_FALSE(bounds[1].held());
  EXPECT_DOUBLE_EQ(bounds[2].value, 1.0);
  EXPECT_FALSE(bounds[2].held());
}

TEST(LatencyReport, JsonHasTheKeysThatScriptsRead) {
  const auto json = nlohmann::json::parse(latency_json({}, result_of_hundred_scans()));
  EXPECT_EQ(json.at("latencyMs").at("median"), 50.0);
  EXPECT_EQ(json.at("latencyMs").at("max"), 100.0);
  EXPECT_EQ(json.at("scans").at("mapped"), 100);
  EXPECT_EQ(json.at("scans").at("dropped"), 0);
  EXPECT_EQ(json.at("bounds").at("p99Ms").at("held"), false);
  EXPECT_TRUE(json.at("machine").contains("load"));
}

TEST(LatencyReport, WithoutAMeasuredScanThereIsNone) {
  EXPECT_THROW(latency_bounds({}), std::invalid_argument);
}

}  // namespace
}  // namespace planemap::benchmark

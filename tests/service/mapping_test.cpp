#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "common/counters.hpp"
#include "ingest/scan_intake.hpp"
#include "mapping/mapping_service.hpp"
#include "mapping/scan_queue.hpp"
#include "wire_messages.hpp"

namespace planemap::service {
namespace {

constexpr std::int64_t kSecond = 1000000;

RegisteredScan empty_scan(std::int64_t utime) {
  PointScan scan;
  scan.utime = utime;
  return RegisteredScan{0, scan, Eigen::Isometry3d::Identity()};
}
RegisteredScan wall_scan(std::int64_t utime) {
  DepthScan scan;
  scan.utime = utime;
  scan.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
  scan.depth.assign(80 * 60, 1000);
  return RegisteredScan{0, scan, Eigen::Isometry3d::Identity()};
}

std::int64_t sum_of_prefix(const CounterValues& values, const std::string& prefix) {
  std::int64_t sum = 0;
  for (const auto& entry : values) {
    if (entry.first.rfind(prefix, 0) == 0) sum += entry.second;
  }
  return sum;
}
/// received - mapped - dropped - rejected - waiting.
std::int64_t unaccounted(const CounterValues& values) {
  return values.at("scans.received") - values.at("scans.mapped") - values.at("scans.waiting") -
         sum_of_prefix(values, "scans.dropped.") - sum_of_prefix(values, "scans.rejected.");
}

TEST(ScanQueue, DropsTheOldestWhenFull) {
  ScanQueue queue(2);
  EXPECT_EQ(queue.push_dropping_oldest(empty_scan(1)), 0u);
  EXPECT_EQ(queue.push_dropping_oldest(empty_scan(2)), 0u);
  EXPECT_EQ(queue.push_dropping_oldest(empty_scan(3)), 1u);
  EXPECT_EQ(queue.size(), 2u);
  std::stop_source stop;
  EXPECT_EQ(utime_of(queue.pop(stop.get_token())->scan), 2);
  EXPECT_EQ(utime_of(queue.pop(stop.get_token())->scan), 3);
}

TEST(ScanQueue, StopEndsTheWait) {
  ScanQueue queue(2);
  std::stop_source stop;
  auto popped = std::async(std::launch::async, [&] { return queue.pop(stop.get_token()); });
  stop.request_stop();
  EXPECT_EQ(popped.get(), nullptr);
  queue.push_dropping_oldest(empty_scan(1));
  EXPECT_EQ(queue.pop(stop.get_token()), nullptr);
  EXPECT_EQ(queue.clear(), 1u);
  EXPECT_EQ(queue.size(), 0u);
}

TEST(ScanQueue, RefusesACapacityOfNone) {
  EXPECT_THROW(ScanQueue(0), std::invalid_argument);
}

TEST(Counters, EveryScanIsAccountedForAtEveryInstantWhileThreadsRun) {
  ServiceConfig config;
  config.queue.scans = 2;
  Counters counters;
  std::promise<void> mapped;
  std::once_flag once;
  MappingService mapping(config, 1, counters, [&] { std::call_once(once, [&] { mapped.set_value(); }); });
  ScanIntake intake(
      config, counters, [&](RegisteredScan&& scan) { mapping.push(std::move(scan)); }, [](const std::string&) {});
  std::atomic<bool> is_done = false;
  auto watcher = std::async(std::launch::async, [&] {
    int looks = 0;
    do {
      const CounterValues values = counters.values();
      EXPECT_EQ(unaccounted(values), 0);
      EXPECT_GE(values.at("scans.waiting"), 0);
      ++looks;
    } while (!is_done);
    return looks;
  });
  auto broken = wall_message(kSecond, 0);
  broken.crc32 ^= 1;
  for (int i = 0; i < 300; ++i) {
    const std::int64_t utime = 10 * kSecond + i * 33333;
    if (i % 10 != 3) intake.on_message("POSE", encoded(pose_message(utime)), 0.0);
    intake.on_message("PLANEMAP_SCAN", encoded(i % 7 == 0 ? broken : wall_message(utime, i)), 0.0);
  }
  intake.finish();
  mapped.get_future().wait();
  mapping.stop();
  is_done = true;
  EXPECT_GT(watcher.get(), 0);
  const CounterValues values = counters.values();
  EXPECT_EQ(unaccounted(values), 0);
  EXPECT_EQ(values.at("scans.received"), 300);
  EXPECT_EQ(values.at("scans.waiting"), 0);
  EXPECT_EQ(values.at("scans.rejected.checksum"), 43);
  EXPECT_GE(values.at("scans.mapped"), 1);
}

TEST(MappingService, PublishesASnapshotAfterEachScan) {
  Counters counters;
  std::promise<void> mapped;
  MappingService mapping(ServiceConfig{}, 77, counters, [&] { mapped.set_value(); });
  const auto before = mapping.snapshot();
  ASSERT_NE(before, nullptr);
  EXPECT_EQ(before->epoch(), 77u);
  EXPECT_EQ(before->planes().size(), 0u);
  counters.scan_received();
  mapping.push(wall_scan(5 * kSecond));
  mapped.get_future().wait();
  const auto after = mapping.snapshot();
  EXPECT_EQ(before->planes().size(), 0u) << "a snapshot never changes";
  ASSERT_EQ(after->planes().size(), 1u);
  EXPECT_NEAR(after->planes()[0]->plane.signed_distance_m({0.0, 0.0, 1.0}), 0.0, 1e-3);
  EXPECT_NEAR(after->planes()[0]->plane.normal().z(), -1.0, 1e-6);
  EXPECT_EQ(after->utime(), 5 * kSecond);
  const MappingStats stats = mapping.stats(steady_now_s());
  EXPECT_EQ(stats.mapped, 1);
  EXPECT_EQ(stats.last_scan_utime, 5 * kSecond);
  EXPECT_GT(stats.scan_ms_p50, 0.0);
  EXPECT_EQ(stats.scan_ms_p50, stats.scan_ms_max);
}

TEST(MappingService, ReadersAndTheMapperDoNotDisturbEachOther) {
  Counters counters;
  ServiceConfig config;
  config.queue.scans = 1000;
  std::atomic<int> mapped = 0;
  std::promise<void> all_mapped;
  MappingService mapping(config, 1, counters, [&] {
    if (++mapped == 60) all_mapped.set_value();
  });
  std::atomic<bool> is_done = false;
  std::vector<std::future<int>> readers;
  for (int i = 0; i < 2; ++i) {
    readers.push_back(std::async(std::launch::async, [&] {
      int cells = 0;
      std::uint64_t revision = 0;
      do {
        const auto snapshot = mapping.snapshot();
        EXPECT_GE(snapshot->revision(), revision);
        revision = snapshot->revision();
        snapshot->for_each_cell([&](const CellView& cell) { cells += cell.count > 0 ? 1 : 0; });
      } while (!is_done);
      return cells;
    }));
  }
  for (int i = 0; i < 60; ++i) {
    counters.scan_received();
    mapping.push(wall_scan(kSecond + i));
  }
  all_mapped.get_future().wait();
  is_done = true;
  for (auto& reader : readers) reader.get();
  EXPECT_EQ(counters.value("scans.mapped"), 60);
}

TEST(MappingService, StopCountsWhatWasStillWaiting) {
  Counters counters;
  ServiceConfig config;
  config.queue.scans = 100;
  {
    MappingService mapping(config, 1, counters, {});
    for (int i = 0; i < 50; ++i) {
      counters.scan_received();
      mapping.push(wall_scan(kSecond + i));
    }
  }
  EXPECT_EQ(counters.value("scans.waiting"), 0);
  EXPECT_EQ(counters.value("scans.mapped") + counters.value("scans.dropped.shutdown"), 50);
}

}  // namespace
}  // namespace planemap::service

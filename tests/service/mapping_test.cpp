#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "common/counters.hpp"
#include "ingest/scan_intake.hpp"
#include "mapping/mapping_service.hpp"
#include "mapping/scan_queue.hpp"
#include "serve/status_board.hpp"
#include "support/captured_log.hpp"
#include "support/messages.hpp"

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

TEST(ScanQueue, AnInterruptEndsOneWait) {
  ScanQueue queue(2);
  std::stop_source stop;
  queue.push_dropping_oldest(empty_scan(1));
  queue.interrupt();
  EXPECT_EQ(queue.pop(stop.get_token()), nullptr);
  EXPECT_NE(queue.pop(stop.get_token()), nullptr);
  auto popped = std::async(std::launch::async, [&] { return queue.pop(stop.get_token()); });
  queue.interrupt();
  EXPECT_EQ(popped.get(), nullptr);
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

RegisteredScan wall_scan_of_map(std::uint64_t map_number, std::int64_t utime) {
  RegisteredScan scan = wall_scan(utime);
  scan.map_number = map_number;
  return scan;
}

TEST(MappingService, AScanOfTheNextMapBeginsItInAGreaterEpoch) {
  Counters counters;
  ServiceConfig config;
  config.queue.scans = 1000;
  std::promise<void> all_mapped;
  std::vector<std::shared_ptr<const MapSnapshot>> snapshots;  // of the mapper's thread until all are mapped
  MappingService* service = nullptr;
  std::promise<void> is_set;
  auto set = is_set.get_future().share();
  MappingService mapping(config, 77, counters, [&] {
    set.wait();
    snapshots.push_back(service->snapshot());
    if (snapshots.size() == 5) all_mapped.set_value();
  });
  service = &mapping;
  is_set.set_value();
  std::int64_t utime = kSecond;
  for (const std::uint64_t map_number : {0, 0, 0, 1, 1}) {
    counters.scan_received();
    mapping.push(wall_scan_of_map(map_number, ++utime));
  }
  all_mapped.get_future().wait();
  std::vector<std::uint64_t> epochs;
  std::vector<std::uint64_t> points;
  for (const auto& snapshot : snapshots) {
    epochs.push_back(snapshot->epoch());
    ASSERT_EQ(snapshot->planes().size(), 1u);
    points.push_back(snapshot->planes()[0]->point_count);
  }
  EXPECT_EQ(epochs, (std::vector<std::uint64_t>{77, 77, 77, 78, 78}));
  EXPECT_EQ(points[3], points[0]) << "the new map holds its first scan and nothing of the old one";
  EXPECT_EQ(points[4], points[1]);
  EXPECT_EQ(counters.value("map.resets"), 1);
  EXPECT_EQ(counters.value("scans.mapped"), 5);
}

TEST(MappingService, ANewMapBeginsThoughItsFirstScanFellOutOfTheQueue) {
  Counters counters;
  ServiceConfig config;
  config.queue.scans = 1;
  std::promise<void> first_mapped;
  std::promise<void> last_mapped;
  std::promise<void> may_go_on;
  auto go_on = may_go_on.get_future().share();
  int mapped = 0;
  MappingService mapping(config, 77, counters, [&] {
    if (++mapped == 2) return last_mapped.set_value();
    first_mapped.set_value();
    go_on.wait();
  });
  const auto push = [&](std::uint64_t map_number, std::int64_t utime) {
    counters.scan_received();
    mapping.push(wall_scan_of_map(map_number, utime));
  };
  push(0, kSecond);
  first_mapped.get_future().wait();
  push(1, kSecond + 1);
  push(1, kSecond + 2);  // the one before has to go
  may_go_on.set_value();
  last_mapped.get_future().wait();
  EXPECT_EQ(mapping.snapshot()->epoch(), 78u);
  EXPECT_EQ(counters.value("map.resets"), 1);
  EXPECT_EQ(counters.value("scans.dropped.queue_full"), 1);
}

TEST(MappingService, NewMapsByTheDozenAreOneLineInTheLog) {
  const CapturedLog log;
  Counters counters;
  ServiceConfig config;
  config.queue.scans = 1000;
  int mapped = 0;
  std::promise<void> all_mapped;
  MappingService mapping(config, 1, counters, [&] {
    if (++mapped == 24) all_mapped.set_value();
  });
  for (std::uint64_t map_number = 0; map_number < 24; ++map_number) {
    counters.scan_received();
    RegisteredScan scan = empty_scan(kSecond);
    scan.map_number = map_number;
    mapping.push(std::move(scan));
  }
  all_mapped.get_future().wait();
  mapping.stop();
  EXPECT_EQ(counters.value("map.resets"), 23);
  EXPECT_EQ(mapping.snapshot()->epoch(), 24u);
  const std::string text = log.text();
  EXPECT_NE(text.find("a new map begins, epoch 2; that of epoch 1 had 0 planes, revision 0"), std::string::npos)
      << text;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
}

TEST(StatusBoard, SaysThatTheMapperCannotKeepUpWhereItsQueueIsFull) {
  Counters counters;
  ServiceConfig config;
  config.queue.scans = 2;
  std::promise<void> first_mapped;
  std::promise<void> may_go_on;
  auto go_on = may_go_on.get_future().share();
  std::once_flag once;
  MappingService mapping(config, 1, counters, [&] {
    std::call_once(once, [&] { first_mapped.set_value(); });
    go_on.wait();
  });
  ScanIntake intake(
      config, counters, [&](RegisteredScan&& scan) { mapping.push(std::move(scan)); }, [](const std::string&) {});
  const auto send = [&](int i) {
    const std::int64_t utime = kSecond + i * 33333;
    intake.on_message("POSE", encoded(pose_message(utime)), steady_now_s());
    intake.on_message("PLANEMAP_SCAN", encoded(wall_message(utime, i)), steady_now_s());
  };
  send(0);
  first_mapped.get_future().wait();  // and the mapper stands still
  for (int i = 1; i <= 5; ++i) send(i);
  StatusBoard board(intake, mapping, counters);
  // As long after the scan that was mapped as makes it idle: the others were dropped later.
  const double idle_from_s = mapping.stats(steady_now_s()).last_mapped_host_s + kIdleAfterS + 1e-6;
  EXPECT_EQ(board.status(idle_from_s, 0).idle_reason,
            "the mapper cannot keep up: 3 scans were dropped from its full queue (queue.scans = 2)");
  may_go_on.set_value();
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

TEST(MappingService, TellsOfEachMappedScanOnceItsSnapshotIsThere) {
  Counters counters;
  MappingService mapping(ServiceConfig{}, 7, counters, {});
  std::promise<void> told;
  mapping.set_scan_listener([&](const MappedScan& mapped) {
    EXPECT_EQ(utime_of(mapped.scan.scan), kSecond);
    EXPECT_EQ(mapped.epoch, 7u);
    EXPECT_EQ(mapping.snapshot()->utime(), kSecond);
    EXPECT_GT(mapped.stage_ms[0], 0.0);
    EXPECT_GE(mapped.scan_ms, mapped.stage_ms[0]);
    told.set_value();
  });
  counters.scan_received();
  mapping.push(wall_scan(kSecond));
  told.get_future().wait();
  mapping.set_scan_listener({});  // once it has returned, nobody is told any more
  counters.scan_received();
  mapping.push(wall_scan(kSecond + 1));
  mapping.stop();
}

TEST(MappingService, DropsScansWhilePausedAndMapsThemAgain) {
  Counters counters;
  std::promise<void> mapped;
  MappingService mapping(ServiceConfig{}, 1, counters, [&] { mapped.set_value(); });
  mapping.pause();
  EXPECT_TRUE(mapping.stats(0.0).is_paused);
  for (int i = 0; i < 3; ++i) {
    counters.scan_received();
    mapping.push(wall_scan(kSecond + i));
  }
  EXPECT_EQ(counters.value("scans.dropped.paused"), 3);
  mapping.resume();
  EXPECT_FALSE(mapping.is_paused());
  counters.scan_received();
  mapping.push(wall_scan(2 * kSecond));
  mapped.get_future().wait();
  mapping.stop();
  EXPECT_EQ(counters.value("scans.mapped"), 1);
  EXPECT_EQ(unaccounted(counters.values()), 0);
}

TEST(MappingService, PausingDropsWhatWaits) {
  Counters counters;
  std::promise<void> first_mapped;
  std::promise<void> may_go_on;
  const auto go_on = may_go_on.get_future().share();
  std::once_flag once;
  MappingService mapping(ServiceConfig{}, 1, counters, [&] {
    std::call_once(once, [&] { first_mapped.set_value(); });
    go_on.wait();
  });
  for (int i = 0; i < 5; ++i) {
    counters.scan_received();
    mapping.push(wall_scan(kSecond + i));
  }
  first_mapped.get_future().wait();  // and the mapper stands still
  mapping.pause();
  EXPECT_EQ(counters.value("scans.dropped.paused"), 4);
  may_go_on.set_value();
  mapping.stop();
  EXPECT_EQ(counters.value("scans.mapped"), 1);
  EXPECT_EQ(unaccounted(counters.values()), 0);
}

TEST(MappingService, AResetBeginsAnEmptyMapOfAGreaterEpoch) {
  Counters counters;
  std::promise<void> first_mapped;
  std::once_flag once;
  MappingService mapping(ServiceConfig{}, 77, counters,
                         [&] { std::call_once(once, [&] { first_mapped.set_value(); }); });
  counters.scan_received();
  mapping.push(wall_scan(kSecond));
  first_mapped.get_future().wait();
  EXPECT_EQ(mapping.reset(std::chrono::seconds(30)), 78u);
  EXPECT_EQ(mapping.snapshot()->epoch(), 78u);
  EXPECT_EQ(mapping.snapshot()->planes().size(), 0u);
  EXPECT_EQ(mapping.reset(std::chrono::seconds(30)), 79u);
  EXPECT_EQ(counters.value("map.resets"), 2);
}

TEST(MappingService, AMapThatAJumpBeginsAfterAResetIsOfAGreaterEpochStill) {
  Counters counters;
  std::promise<void> mapped;
  std::once_flag once;
  MappingService mapping(ServiceConfig{}, 77, counters, [&] {
    if (counters.value("scans.mapped") == 1) std::call_once(once, [&] { mapped.set_value(); });
  });
  EXPECT_EQ(mapping.reset(std::chrono::seconds(30)), 78u);
  counters.scan_received();
  mapping.push(wall_scan_of_map(1, kSecond));
  mapped.get_future().wait();
  EXPECT_EQ(mapping.snapshot()->epoch(), 79u);
}

TEST(MappingService, AResetGivesUpOnAMapperThatHasEnded) {
  Counters counters;
  MappingService mapping(ServiceConfig{}, 77, counters, {});
  mapping.stop();
  EXPECT_EQ(mapping.reset(std::chrono::milliseconds(1)), std::nullopt);
}

}  // namespace
}  // namespace planemap::service

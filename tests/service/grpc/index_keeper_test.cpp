// When an index is made, and what those wait for who ask meanwhile.
#include "serve/grpc/index_keeper.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <semaphore>
#include <thread>
#include <vector>

namespace planemap::service {
namespace {

RegisteredScan wall_scan(std::int64_t utime = 1000000) {
  DepthScan scan;
  scan.utime = utime;
  scan.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
  scan.depth.assign(80 * 60, 1000);
  return RegisteredScan{0, scan, Eigen::Isometry3d::Identity()};
}

TEST(IndexKeeper, WhoAsksWaitsForTheIndexThatIsBeingMadeAndNoLonger) {
  ServiceConfig config;
  config.grpc.index_age_s = 60.0;
  Counters counters;
  std::promise<void> mapped;
  MappingService mapping(config, 1, counters, [&] { mapped.set_value(); });
  std::promise<void> making;
  std::promise<void> release;
  std::atomic<int> made = 0;
  IndexKeeper keeper(config, mapping, [&](const auto&) {
    if (++made > 1) return;
    making.set_value();
    release.get_future().wait();
  });
  auto first = std::async(std::launch::async, [&] { return keeper.current(); });
  making.get_future().wait();
  counters.scan_received();
  mapping.push(wall_scan());
  mapped.get_future().wait();
  auto second = std::async(std::launch::async, [&] { return keeper.current(); });
  // Were it later than this, it would find the index made, which is as well.
  EXPECT_EQ(second.wait_for(std::chrono::milliseconds(100)), std::future_status::timeout);
  release.set_value();
  EXPECT_EQ(second.get(), first.get());
  EXPECT_EQ(made, 1) << "the newer snapshot is not 60 s newer";
}

/// A mapper that is waited for, scan by scan.
class KeptIndexes : public testing::Test {
 protected:
  KeptIndexes() { config_.grpc.index_age_s = 0.0; }
  void map_one() {
    const std::int64_t number = ++scans_;
    counters_.scan_received();
    mapping_.push(wall_scan(1000000 + number * 33333));
    while (mapping_.snapshot()->utime() < 1000000 + number * 33333) mapped_.acquire();
  }
  static std::shared_ptr<const MapIndex> again(IndexKeeper& keeper, const MapIndex& index) {
    const MapSnapshot& snapshot = index.snapshot();
    return keeper.of_version(snapshot.epoch(), snapshot.revision(), snapshot.utime());
  }

  ServiceConfig config_;
  Counters counters_;
  std::counting_semaphore<> mapped_{0};
  std::int64_t scans_ = 0;
  MappingService mapping_{config_, 1, counters_, [this] { mapped_.release(); }};
};

TEST_F(KeptIndexes, AreTheLastOnesThatWereAskedFor) {
  IndexKeeper keeper(config_, mapping_, [](const auto&) {});
  std::vector<std::shared_ptr<const MapIndex>> given;
  for (std::size_t i = 0; i < IndexKeeper::kKeptIndexes; ++i) {
    map_one();
    given.push_back(keeper.current());
    keeper.keep(given.back());
    EXPECT_EQ(again(keeper, *given[0]), given[0]) << i;
  }
  map_one();
  given.push_back(keeper.current());
  EXPECT_EQ(again(keeper, *given.back()), nullptr) << "nobody asked for it to be kept";
  keeper.keep(given.back());
  EXPECT_EQ(again(keeper, *given[1]), nullptr) << "the one for which nobody asked the longest";
  for (const std::size_t i : {0, 2, 8}) EXPECT_EQ(again(keeper, *given[i]), given[i]) << i;
  EXPECT_EQ(keeper.of_version(2, given[0]->snapshot().revision(), given[0]->snapshot().utime()), nullptr);
}

TEST_F(KeptIndexes, AreLetGoWhenNobodyAsksForThem) {
  IndexKeeper keeper(
      config_, mapping_, [](const auto&) {}, 0.02);
  map_one();
  const std::weak_ptr<const MapIndex> old = [&] {
    auto index = keeper.current();
    keeper.keep(index);
    return index;
  }();
  map_one();
  keeper.current();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!old.expired() && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  EXPECT_TRUE(old.expired());
}

}  // namespace
}  // namespace planemap::service

// When an index is made, and what those wait for who ask meanwhile.
#include "serve/grpc/index_keeper.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>

namespace planemap::service {
namespace {

RegisteredScan wall_scan() {
  DepthScan scan;
  scan.utime = 1000000;
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

}  // namespace
}  // namespace planemap::service

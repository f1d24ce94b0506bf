#include "sync/synchronizer.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace planemap::service {
namespace {

constexpr std::int64_t kSecond = 1000000;

StampedPose pose_at(std::int64_t utime, double x_m, double yaw_rad = 0.0) {
  return {utime, {x_m, 0.0, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()))};
}
Scan scan_at(std::int64_t utime, std::size_t points = 1) {
  PointScan scan;
  scan.utime = utime;
  scan.xyz_m.assign(3 * points, 1.0F);
  return scan;
}
std::vector<std::int64_t> utimes(const std::vector<RegisteredScan>& scans) {
  std::vector<std::int64_t> result;
  for (const auto& scan : scans) result.push_back(utime_of(scan.scan));
  return result;
}
/// Two sensors, front and back, on one pose channel; a third with a pose channel of its own.
ServiceConfig three_inputs() {
  ServiceConfig config;
  config.inputs.resize(3);
  config.inputs[1].name = "back";
  config.inputs[1].channel = "BACK";
  config.inputs[2].name = "other";
  config.inputs[2].channel = "OTHER";
  config.inputs[2].pose_channel = "OTHER_POSE";
  return config;
}

TEST(Synchronizer, ScanWaitsForThePoseAfterIt) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(10 * kSecond, 0.0));
  sync.add_scan(0, scan_at(10 * kSecond + 50000), 1.0);
  EXPECT_TRUE(sync.take_ready(1.1).ready.empty());
  EXPECT_EQ(sync.waiting(0), 1u);
  sync.add_pose(0, pose_at(10 * kSecond + 100000, 0.1));
  const auto results = sync.take_ready(1.2);
  ASSERT_EQ(results.ready.size(), 1u);
  EXPECT_TRUE(results.dropped.empty());
  EXPECT_NEAR(results.ready[0].T_world_sensor.translation().x(), 0.05, 1e-12);
  EXPECT_EQ(sync.waiting(0), 0u);
  EXPECT_EQ(sync.waiting_bytes(), 0u);
}

TEST(Synchronizer, AppliesTheSensorsPlaceOnTheBody) {
  ServiceConfig config;
  config.inputs[0].translation_m = {0.2, 0.0, 1.0};
  // Optical axes on a body with x forward, y left, z up: z forward is x, x right is -y.
  config.inputs[0].rotation_wxyz = {0.5, -0.5, 0.5, -0.5};
  Synchronizer sync(config);
  sync.add_pose(0, pose_at(kSecond, 3.0, std::numbers::pi / 2));  // the body looks along world y
  sync.add_scan(0, scan_at(kSecond), 0.0);
  const auto results = sync.take_ready(0.0);
  ASSERT_EQ(results.ready.size(), 1u);
  const Eigen::Vector3d ahead_m = results.ready[0].T_world_sensor * Eigen::Vector3d(0.0, 0.0, 2.0);
  EXPECT_NEAR((ahead_m - Eigen::Vector3d(3.0, 2.2, 1.0)).norm(), 0.0, 1e-12);
  EXPECT_FALSE(results.ready[0].pose_covariance);
}

TEST(Synchronizer, TheBodysCovarianceBecomesTheSensors) {
  ServiceConfig config;
  config.inputs[0].translation_m = {2.0, 0.0, 0.0};
  config.inputs[0].rotation_wxyz = {0.5, -0.5, 0.5, -0.5};  // as above
  Synchronizer sync(config);
  auto pose = pose_at(kSecond, 0.0);
  pose.covariance = PoseCovariance::Zero();
  (*pose.covariance)(5, 5) = 1e-6;  // yaw, about the body's z
  sync.add_pose(0, pose);
  sync.add_scan(0, scan_at(kSecond), 0.0);
  const auto results = sync.take_ready(0.0);
  ASSERT_EQ(results.ready.size(), 1u);
  // The body's z is the sensor's -y; 2 m ahead the yaw r moves the sensor by 2 r to the left, along its -x.
  PoseCovariance expected = PoseCovariance::Zero();
  expected(4, 4) = 1e-6;
  expected(0, 0) = 4e-6;
  expected(0, 4) = expected(4, 0) = 2e-6;
  const PoseCovariance stated = results.ready[0].pose_covariance.value();
  EXPECT_TRUE(stated.isApprox(expected, 1e-12)) << stated;
}

TEST(Synchronizer, PoseAtTheScansTimeNeedsNoWait) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(10 * kSecond, 0.0));
  sync.add_scan(0, scan_at(10 * kSecond + 1000), 0.0);
  EXPECT_EQ(sync.take_ready(0.0).ready.size(), 1u);
}

TEST(Synchronizer, KeepsTheOrderOfASensor) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(kSecond, 0.0));
  sync.add_scan(0, scan_at(kSecond + 30000), 0.0);
  sync.add_scan(0, scan_at(kSecond + 60000), 0.0);
  sync.add_scan(0, scan_at(kSecond + 90000), 0.0);
  EXPECT_TRUE(sync.take_ready(0.0).ready.empty());
  sync.add_pose(0, pose_at(kSecond + 70000, 0.0));
  EXPECT_EQ(utimes(sync.take_ready(0.0).ready), (std::vector<std::int64_t>{kSecond + 30000, kSecond + 60000}));
  sync.add_pose(0, pose_at(kSecond + 100000, 0.0));
  EXPECT_EQ(utimes(sync.take_ready(0.0).ready), (std::vector<std::int64_t>{kSecond + 90000}));
}

TEST(Synchronizer, GivesUpWhenTheHostHasWaited) {
  Synchronizer sync{ServiceConfig{}};  // half a second
  sync.add_pose(0, pose_at(10 * kSecond, 0.0));
  sync.add_scan(0, scan_at(11 * kSecond), 5.0);
  EXPECT_TRUE(sync.take_ready(5.5).dropped.empty());
  const auto results = sync.take_ready(5.51);
  ASSERT_EQ(results.dropped.size(), 1u);
  EXPECT_EQ(results.dropped[0].reason, "no_pose");
  EXPECT_EQ(results.dropped[0].message, "no pose within 0.5 s of scan at 11.000000; last pose on POSE at 10.000000");
}

TEST(Synchronizer, GivesUpWhenTheScansHaveGoneOn) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_scan(0, scan_at(10 * kSecond), 0.0);
  sync.add_scan(0, scan_at(10 * kSecond + 500000), 0.0);
  EXPECT_TRUE(sync.take_ready(0.0).dropped.empty());
  sync.add_scan(0, scan_at(10 * kSecond + 500001), 0.0);
  const auto results = sync.take_ready(0.0);
  ASSERT_EQ(results.dropped.size(), 1u);
  EXPECT_EQ(results.dropped[0].utime, 10 * kSecond);
  EXPECT_EQ(results.dropped[0].message, "no pose on POSE yet (scan at 10.000000)");
  EXPECT_EQ(sync.waiting(0), 2u);
}

TEST(Synchronizer, GapsAndJumpsAreDroppedAtOnce) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(10 * kSecond, 0.0));
  sync.add_pose(0, pose_at(11 * kSecond, 0.0));
  sync.add_pose(0, pose_at(11 * kSecond + 100000, 4.0));
  sync.add_scan(0, scan_at(10 * kSecond + 500000), 0.0);
  sync.add_scan(0, scan_at(11 * kSecond + 50000), 0.0);
  const auto results = sync.take_ready(0.0);
  ASSERT_EQ(results.dropped.size(), 2u);
  EXPECT_EQ(results.dropped[0].reason, "pose_gap");
  EXPECT_NE(results.dropped[0].message.find("are 1.000 s apart, more than pose.max_gap_s = 0.5"), std::string::npos);
  EXPECT_EQ(results.dropped[1].reason, "pose_jump");
}

TEST(Synchronizer, ScanBeforeAllPosesIsDroppedAfterItsWait) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(10 * kSecond, 0.0));
  sync.add_scan(0, scan_at(9 * kSecond), 1.0);
  EXPECT_TRUE(sync.take_ready(1.0).dropped.empty());  // an older pose may be late
  const auto results = sync.take_ready(2.0);
  ASSERT_EQ(results.dropped.size(), 1u);
  EXPECT_EQ(results.dropped[0].reason, "before_poses");
}

TEST(Synchronizer, LatePoseHelpsTheScanBeforeIt) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(10 * kSecond + 100000, 1.0));
  sync.add_scan(0, scan_at(10 * kSecond + 50000), 0.0);
  EXPECT_TRUE(sync.take_ready(0.0).ready.empty());
  sync.add_pose(0, pose_at(10 * kSecond, 0.5));  // out of order
  const auto results = sync.take_ready(0.0);
  ASSERT_EQ(results.ready.size(), 1u);
  EXPECT_NEAR(results.ready[0].T_world_sensor.translation().x(), 0.75, 1e-12);
}

TEST(Synchronizer, GoesOnAfterALogRestart) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(100 * kSecond, 0.0));
  sync.add_scan(0, scan_at(100 * kSecond + 30000), 0.0);
  // The log begins anew; its first scan is faster than its first pose.
  sync.add_scan(0, scan_at(50 * kSecond + 50000), 0.0);
  EXPECT_TRUE(sync.take_ready(0.0).ready.empty());
  EXPECT_EQ(sync.add_pose(0, pose_at(50 * kSecond, 0.0)), PoseInsert::kRestarted);
  sync.add_pose(0, pose_at(50 * kSecond + 100000, 1.0));
  const auto results = sync.take_ready(0.0);
  ASSERT_EQ(results.dropped.size(), 1u);
  EXPECT_EQ(results.dropped[0].reason, "clock_restart");
  EXPECT_EQ(results.dropped[0].utime, 100 * kSecond + 30000);
  EXPECT_EQ(utimes(results.ready), (std::vector<std::int64_t>{50 * kSecond + 50000}));
}

TEST(Synchronizer, ScansOfAShortLogInALoopGetThePosesOfTheirRun) {
  Synchronizer sync{ServiceConfig{}};  // poses are kept for 10 s
  std::vector<double> x_m;
  const auto take = [&] {
    const auto results = sync.take_ready(0.0);
    EXPECT_TRUE(results.dropped.empty());
    for (const auto& scan : results.ready) x_m.push_back(scan.T_world_sensor.translation().x());
  };
  for (int run = 0; run < 3; ++run) {
    for (int i = 0; i <= 20; ++i) {  // 2 s; each scan is faster than its pose, and each run is elsewhere
      if (i < 20) sync.add_scan(0, scan_at(kSecond + i * 100000), 0.0);
      take();
      sync.add_pose(0, pose_at(kSecond + i * 100000, 100.0 * run + 0.01 * i));
      take();
    }
  }
  ASSERT_EQ(x_m.size(), 60u);
  for (std::size_t k = 0; k < 60; ++k) {
    EXPECT_NEAR(x_m[k], 100.0 * static_cast<double>(k / 20) + 0.01 * static_cast<double>(k % 20), 1e-9) << k;
  }
}

TEST(Synchronizer, PosesMayRestartBeforeTheScansDo) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(5 * kSecond, 0.0));
  sync.add_scan(0, scan_at(5 * kSecond), 0.0);
  EXPECT_EQ(sync.take_ready(0.0).ready.size(), 1u);
  EXPECT_EQ(sync.add_pose(0, pose_at(2 * kSecond, 7.0)), PoseInsert::kRestarted);
  sync.add_scan(0, scan_at(2 * kSecond), 0.0);
  const auto results = sync.take_ready(0.0);
  ASSERT_EQ(results.ready.size(), 1u) << "nothing to wait for";
  EXPECT_EQ(results.ready[0].T_world_sensor.translation().x(), 7.0);
}

TEST(Synchronizer, AScanThatIsOnlyLateIsPlacedByTheHistory) {
  Synchronizer sync{ServiceConfig{}};
  for (int i = 0; i <= 40; ++i) sync.add_pose(0, pose_at(kSecond + i * 100000, 0.1 * i));  // to 5 s
  sync.add_scan(0, scan_at(5 * kSecond), 0.0);
  EXPECT_EQ(sync.take_ready(0.0).ready.size(), 1u);
  sync.add_scan(0, scan_at(2 * kSecond), 0.0);  // or has the clock stepped back? The poses may tell.
  EXPECT_TRUE(sync.take_ready(0.0).ready.empty());
  sync.add_pose(0, pose_at(5 * kSecond + 100000, 4.1));
  sync.add_scan(0, scan_at(5 * kSecond + 50000), 0.1);
  const auto results = sync.take_ready(0.1);
  ASSERT_EQ(results.ready.size(), 2u) << "the scans have gone on by more than a scan waits";
  EXPECT_NEAR(results.ready[0].T_world_sensor.translation().x(), 1.0, 1e-12);
  EXPECT_NEAR(results.ready[1].T_world_sensor.translation().x(), 4.05, 1e-12);
  sync.add_scan(0, scan_at(3 * kSecond), 1.0);
  EXPECT_TRUE(sync.take_ready(1.5).ready.empty());
  EXPECT_EQ(sync.take_ready(1.51).ready.size(), 1u) << "by the host's clock, too";
}

TEST(Synchronizer, InARecordingAScanFromTheFutureDelaysTheOthersByTheirOwnTimeOnly) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_scan(0, scan_at(4000000000 * kSecond), 0.0);
  std::size_t ready = 0;
  std::size_t dropped = 0;
  for (int i = 0; i < 20; ++i) {
    sync.add_pose(0, pose_at(10 * kSecond + i * 100000, 0.0));
    sync.add_scan(0, scan_at(10 * kSecond + i * 100000), 0.0);  // the host's clock stands still
    const auto results = sync.take_ready(0.0);
    ready += results.ready.size();
    dropped += results.dropped.size();
  }
  EXPECT_EQ(ready, 20u);
  EXPECT_EQ(dropped, 1u);
}

/// Two sensors on one pose channel, where a jump begins a new map.
ServiceConfig resetting_inputs() {
  ServiceConfig config = three_inputs();
  config.pose.jump = "reset";
  return config;
}

std::vector<std::uint64_t> map_numbers(const std::vector<RegisteredScan>& scans) {
  std::vector<std::uint64_t> numbers;
  for (const auto& scan : scans) numbers.push_back(scan.map_number);
  return numbers;
}

/// Poses each tenth of a second, with a jump of 5 m before the third.
void add_poses_with_a_jump(Synchronizer& sync) {
  for (int i = 0; i < 4; ++i) sync.add_pose(0, pose_at(kSecond + i * 100000, i < 2 ? 0.0 : 5.0));
}

TEST(Synchronizer, ScansBehindAJumpBelongToANewMap) {
  Synchronizer sync(resetting_inputs());
  for (const int ms : {50, 100, 150, 200, 250}) sync.add_scan(0, scan_at(kSecond + ms * 1000), 0.0);
  add_poses_with_a_jump(sync);
  const auto results = sync.take_ready(0.0);
  EXPECT_EQ(map_numbers(results.ready), (std::vector<std::uint64_t>{0, 0, 1, 1}));
  ASSERT_EQ(results.dropped.size(), 1u);
  EXPECT_EQ(results.dropped[0].reason, "pose_jump");
}

TEST(Synchronizer, UnlessItIsToldSoAJumpBeginsNoNewMap) {
  Synchronizer sync(three_inputs());
  for (const int ms : {50, 250, 50}) sync.add_scan(0, scan_at(kSecond + ms * 1000), 0.0);
  add_poses_with_a_jump(sync);
  const auto results = sync.take_ready(0.0);
  EXPECT_EQ(map_numbers(results.ready), (std::vector<std::uint64_t>{0, 0, 0}));
}

TEST(Synchronizer, ALateScanFromBeforeTheJumpIsNotPutIntoTheNewMap) {
  Synchronizer sync(resetting_inputs());
  add_poses_with_a_jump(sync);
  sync.add_scan(0, scan_at(kSecond + 50000), 0.0);
  sync.add_scan(0, scan_at(kSecond + 250000), 0.0);
  EXPECT_EQ(map_numbers(sync.take_ready(0.0).ready), (std::vector<std::uint64_t>{0, 1}));
  sync.add_scan(1, scan_at(kSecond + 60000), 0.0);  // of another sensor on the same body
  sync.add_scan(1, scan_at(kSecond + 260000), 0.0);
  const auto results = sync.take_ready(0.0);
  EXPECT_EQ(map_numbers(results.ready), (std::vector<std::uint64_t>{1}));
  ASSERT_EQ(results.dropped.size(), 1u);
  EXPECT_EQ(results.dropped[0].reason, "old_map");
  EXPECT_EQ(results.dropped[0].message,
            "the scan at 1.060000 is from before a jump of the pose on POSE, where a new map has begun");
}

TEST(Synchronizer, AJumpBeforeTheFirstScanNeedsNoNewMap) {
  Synchronizer sync(resetting_inputs());
  add_poses_with_a_jump(sync);
  sync.add_scan(0, scan_at(kSecond + 250000), 0.0);
  EXPECT_EQ(map_numbers(sync.take_ready(0.0).ready), (std::vector<std::uint64_t>{0}));
}

TEST(Synchronizer, AJumpOnOnePoseChannelIsANewMapForAll) {
  Synchronizer sync(resetting_inputs());
  const std::size_t other = sync.stream_of(2);
  sync.add_pose(other, pose_at(kSecond, 0.0));
  sync.add_scan(2, scan_at(kSecond), 0.0);
  EXPECT_EQ(map_numbers(sync.take_ready(0.0).ready), (std::vector<std::uint64_t>{0}));
  add_poses_with_a_jump(sync);
  sync.add_scan(0, scan_at(kSecond + 250000), 0.0);
  EXPECT_EQ(map_numbers(sync.take_ready(0.0).ready), (std::vector<std::uint64_t>{1}));
  sync.add_pose(other, pose_at(kSecond + 300000, 0.0));
  sync.add_scan(2, scan_at(kSecond + 300000), 0.0);
  EXPECT_EQ(map_numbers(sync.take_ready(0.0).ready), (std::vector<std::uint64_t>{1}));
}

TEST(Synchronizer, AScanFromTheFutureDoesNotSilenceTheSensor) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_scan(0, scan_at(4000000000 * kSecond), 0.0);
  sync.take_ready(1.0);
  sync.add_pose(0, pose_at(10 * kSecond, 0.0));
  sync.add_scan(0, scan_at(10 * kSecond + 50000), 1.0);
  sync.add_pose(0, pose_at(10 * kSecond + 100000, 0.0));
  EXPECT_EQ(sync.take_ready(1.0).ready.size(), 1u);
}

TEST(Synchronizer, InputsShareAPoseChannelOrHaveTheirOwn) {
  Synchronizer sync(three_inputs());
  ASSERT_EQ(sync.stream_count(), 2u);
  EXPECT_EQ(sync.stream_of(0), sync.stream_of(1));
  EXPECT_NE(sync.stream_of(0), sync.stream_of(2));
  for (std::size_t input = 0; input < 3; ++input) sync.add_scan(input, scan_at(kSecond), 0.0);
  sync.add_pose(sync.stream_of(0), pose_at(kSecond, 0.0));
  auto results = sync.take_ready(0.0);
  ASSERT_EQ(results.ready.size(), 2u);
  EXPECT_EQ(results.ready[0].input, 0u);
  EXPECT_EQ(results.ready[1].input, 1u);
  sync.add_pose(sync.stream_of(2), pose_at(kSecond, 0.0));
  results = sync.take_ready(0.0);
  ASSERT_EQ(results.ready.size(), 1u);
  EXPECT_EQ(results.ready[0].input, 2u);
}

TEST(Synchronizer, WaitingScansAreBoundedByTheirBytes) {
  ServiceConfig config;
  config.limits.waiting_bytes = 100000;
  Synchronizer sync(config);
  for (int i = 0; i < 20; ++i) sync.add_scan(0, scan_at(kSecond + i, 1000), 0.0);  // 12 kB each
  EXPECT_LE(sync.waiting_bytes(), 100000u);
  const auto results = sync.take_ready(0.0);
  EXPECT_EQ(results.dropped.size() + sync.waiting(0), 20u);
  ASSERT_FALSE(results.dropped.empty());
  EXPECT_EQ(results.dropped[0].reason, "waiting_full");
  EXPECT_EQ(results.dropped[0].utime, kSecond);
}

TEST(Synchronizer, FinishResolvesEverything) {
  Synchronizer sync{ServiceConfig{}};
  sync.add_pose(0, pose_at(kSecond, 0.0));
  sync.add_scan(0, scan_at(kSecond + 500), 0.0);
  sync.add_scan(0, scan_at(kSecond + 20000), 0.0);
  const auto results = sync.finish();
  EXPECT_EQ(utimes(results.ready), (std::vector<std::int64_t>{kSecond + 500}));
  ASSERT_EQ(results.dropped.size(), 1u);
  EXPECT_EQ(results.dropped[0].reason, "no_pose");
  EXPECT_EQ(sync.waiting(0), 0u);
}

}  // namespace
}  // namespace planemap::service

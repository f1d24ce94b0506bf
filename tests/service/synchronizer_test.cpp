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

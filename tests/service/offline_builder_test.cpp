#include "mapping/offline_builder.hpp"

#include <gtest/gtest.h>

#include "support/messages.hpp"

namespace planemap::service {
namespace {

constexpr std::int64_t kSecond = 1000000;

TEST(OfflineBuilder, MapsALogLikeTheDaemon) {
  OfflineBuilder builder(ServiceConfig{}, 5);
  for (int i = 0; i < 10; ++i) {
    const std::int64_t utime = kSecond + i * 66667;
    EXPECT_TRUE(builder.add_event("POSE", encoded(pose_message(utime - 10000))));
    EXPECT_TRUE(builder.add_event("PLANEMAP_SCAN", encoded(zipped(wall_message(utime, i)))));
    EXPECT_FALSE(builder.add_event("ROBOT_STATUS", encoded(pose_message(utime))));
  }
  auto counters = builder.counters();
  EXPECT_EQ(counters.at("scans.mapped"), 9);  // the last one waits for the pose after it
  EXPECT_EQ(counters.at("scans.waiting"), 1);
  builder.finish();
  counters = builder.counters();
  EXPECT_EQ(counters.at("scans.received"), 10);
  EXPECT_EQ(counters.at("scans.dropped.no_pose"), 1);
  EXPECT_EQ(counters.at("scans.waiting"), 0);
  EXPECT_FALSE(builder.last_problem().empty());
  const auto snapshot = builder.snapshot();
  EXPECT_EQ(snapshot->epoch(), 5u);
  ASSERT_EQ(snapshot->planes().size(), 1u);
  EXPECT_EQ(builder.points().total, 9u * 4800u);
  EXPECT_EQ(builder.points().mapped, 9u * 4800u);
  EXPECT_EQ(builder.times().scan_ms.size(), 9u);
  for (const auto& stage : builder.times().stage_ms) EXPECT_EQ(stage.size(), 9u);
}

TEST(OfflineBuilder, NoScanIsDroppedForWantOfTime) {
  ServiceConfig config;
  config.queue.scans = 1;
  OfflineBuilder builder(config, 5);
  for (int i = 0; i < 40; ++i) builder.add_event("PLANEMAP_SCAN", encoded(wall_message(kSecond + i * 10000, i)));
  for (int i = 0; i < 45; ++i) builder.add_event("POSE", encoded(pose_message(kSecond + i * 10000)));
  builder.finish();
  EXPECT_EQ(builder.counters().at("scans.mapped"), 40);
}

TEST(OfflineBuilder, MapsFramesAtTheirPoses) {
  OfflineBuilder builder(ServiceConfig{}, 5);
  DepthScan scan;
  scan.utime = kSecond;
  scan.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
  scan.depth.assign(80 * 60, 1000);
  scan.depth[0] = kNoReturn;
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
  T_world_sensor.translation().z() = 10.0;
  const ScanReport report = builder.add_frame(scan, T_world_sensor);
  EXPECT_EQ(report.points.no_return, 1u);
  EXPECT_EQ(report.new_planes, 1u);
  const auto snapshot = builder.snapshot();
  ASSERT_EQ(snapshot->planes().size(), 1u);
  EXPECT_NEAR(snapshot->planes()[0]->plane.signed_distance_m({0.0, 0.0, 11.0}), 0.0, 1e-3);
  EXPECT_EQ(builder.counters().at("scans.mapped"), 1);
}

TEST(OfflineBuilder, CountsTheCellsThatWereWornAway) {
  OfflineBuilder builder(ServiceConfig{}, 5);
  DepthScan scan;
  scan.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
  std::size_t worn = 0;
  for (int i = 0; i < 25; ++i) {  // a board, and from half a second on the wall a metre behind it
    scan.utime = kSecond + i * kSecond / 10;
    scan.depth.assign(80 * 60, i < 5 ? 1000 : 2000);
    worn += builder.add_frame(scan, Eigen::Isometry3d::Identity()).worn_cells;
    if (i == 4) {
      EXPECT_EQ(builder.snapshot()->planes().size(), 1u);
      EXPECT_EQ(builder.counters().at("cells.worn"), 0);
    }
  }
  EXPECT_GT(worn, 60u);
  EXPECT_EQ(builder.counters().at("cells.worn"), static_cast<std::int64_t>(worn));
}

TEST(OfflineBuilder, AJumpBeginsANewMapWhereItIsToldTo) {
  ServiceConfig config;
  const auto build = [&] {
    auto builder = std::make_unique<OfflineBuilder>(config, 5);
    for (int i = 0; i < 10; ++i) {
      const std::int64_t utime = kSecond + i * 66667;
      builder->add_event("POSE", encoded(pose_message(utime, i < 7 ? 0.0 : 20.0)));
      builder->add_event("PLANEMAP_SCAN", encoded(wall_message(utime, i)));
    }
    builder->finish();
    return builder;
  };
  const auto going_on = build();
  EXPECT_EQ(going_on->counters().at("poses.jumps"), 1);
  EXPECT_EQ(going_on->counters().count("map.resets"), 0u);
  EXPECT_EQ(going_on->snapshot()->epoch(), 5u);
  EXPECT_EQ(going_on->snapshot()->planes().size(), 2u) << "the wall is there twice";
  config.pose.jump = "reset";
  const auto first = build();
  const auto second = build();
  EXPECT_EQ(first->counters().at("map.resets"), 1);
  EXPECT_EQ(first->counters().at("scans.mapped"), 10);
  for (const auto& builder : {first.get(), second.get()}) {
    const auto snapshot = builder->snapshot();
    EXPECT_EQ(snapshot->epoch(), 6u);
    ASSERT_EQ(snapshot->planes().size(), 1u);
    EXPECT_NEAR(snapshot->planes()[0]->centroid_m.x(), 20.0, 0.05);
    EXPECT_LE(snapshot->planes()[0]->point_count, 3u * 4800u);
  }
  EXPECT_EQ(first->snapshot()->planes()[0]->covariance, second->snapshot()->planes()[0]->covariance);
}

/// A wall from a log, and how sure its plane is.
template <class PoseMessage>
PlaneRecord wall_of_log(const PoseErrorConfig& errors, const PoseMessage& pose_at) {
  ServiceConfig config;
  config.pose.error = config.mapper.pose_error = errors;
  OfflineBuilder builder(config, 5);
  for (int i = 0; i < 20; ++i) {
    const std::int64_t utime = kSecond + i * 66667;
    builder.add_event("POSE", encoded(pose_at(utime - 20000)));
    builder.add_event("PLANEMAP_SCAN", encoded(wall_message(utime, i)));
  }
  builder.finish();
  const auto snapshot = builder.snapshot();
  EXPECT_EQ(snapshot->planes().size(), 1u);
  return snapshot->planes().empty() ? PlaneRecord{} : *snapshot->planes()[0];
}

TEST(OfflineBuilder, PlanesAreAsUncertainAsThePosesSay) {
  PoseErrorConfig errors;
  errors.correlation_s = 1.0;
  const auto plain = [](std::int64_t utime) { return pose_message(utime); };
  const auto stating = [](std::int64_t utime) { return pose_cov_message(utime, 0.0, 0.004, 0.002); };
  const PlaneRecord exact = wall_of_log(errors, plain);
  const PlaneRecord stated = wall_of_log(errors, stating);
  errors.sigma_m = 0.004;
  errors.sigma_rad = 0.002;
  const PlaneRecord configured = wall_of_log(errors, plain);
  errors.sigma_m = 0.1;  // for poses that state none
  const PlaneRecord stated_beside = wall_of_log(errors, stating);
  EXPECT_TRUE(stated.covariance.isApprox(configured.covariance, 1e-9)) << stated.covariance << configured.covariance;
  EXPECT_TRUE(stated.covariance.isApprox(stated_beside.covariance, 1e-9));
  // 20 scans in 1.3 s, of errors that last for 1 s, are hardly more than one or two.
  EXPECT_GT(std::sqrt(stated.covariance(3, 3)), 0.002);
  EXPECT_LT(std::sqrt(exact.covariance(3, 3)), 0.0005);
}

TEST(OfflineBuilder, TheSameCallsGiveTheSameMap) {
  const auto build = [] {
    auto builder = std::make_unique<OfflineBuilder>(ServiceConfig{}, 5);
    for (int i = 0; i < 5; ++i) {
      const std::int64_t utime = kSecond + i * 66667;
      builder->add_event("POSE", encoded(pose_message(utime, 0.013 * i)));
      builder->add_event("PLANEMAP_SCAN", encoded(wall_message(utime, i, static_cast<std::uint16_t>(1000 + i))));
    }
    builder->finish();
    return builder->snapshot();
  };
  const auto first = build();
  const auto second = build();
  ASSERT_EQ(first->planes().size(), second->planes().size());
  ASSERT_GT(first->planes().size(), 0u);
  for (std::size_t i = 0; i < first->planes().size(); ++i) {
    EXPECT_EQ(first->planes()[i]->plane.d(), second->planes()[i]->plane.d());
    EXPECT_EQ(first->planes()[i]->covariance, second->planes()[i]->covariance);
  }
}

}  // namespace
}  // namespace planemap::service

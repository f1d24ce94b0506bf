#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "formats/field_formats.hpp"
#include "ingest/idle_reason.hpp"
#include "ingest/kernel_drops.hpp"
#include "ingest/point_filter.hpp"
#include "ingest/rate_limiter.hpp"
#include "ingest/scan_intake.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

constexpr std::int64_t kSecond = 1000000;

DepthScan wall_scan(std::uint16_t depth_mm) {
  DepthScan scan;
  scan.utime = kSecond;
  scan.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
  scan.depth.assign(80 * 60, depth_mm);
  return scan;
}

TEST(PointFilter, RangeLimitsIncludeTheirEnds) {
  InputConfig input;
  input.min_range_m = 1.0;
  input.max_range_m = 2.0;
  DepthScan depth = wall_scan(1500);
  depth.depth[0] = 999;
  depth.depth[1] = 1000;
  depth.depth[2] = 2000;
  depth.depth[3] = 2001;
  depth.depth[4] = kNoReturnHigh;
  Scan scan = depth;
  const auto filtered = PointFilter(input).apply(scan);
  EXPECT_EQ(filtered.out_of_range, 2u);
  EXPECT_EQ(filtered.own_body, 0u);
  const auto& result = std::get<DepthScan>(scan).depth;
  EXPECT_EQ(result[0], kNoReturn);
  EXPECT_EQ(result[1], 1000);
  EXPECT_EQ(result[2], 2000);
  EXPECT_EQ(result[3], kNoReturn);
  EXPECT_EQ(result[4], kNoReturnHigh);
}

TEST(PointFilter, MasksTheBodyInItsOwnFrame) {
  InputConfig input;
  input.translation_m = {0.0, 0.0, 1.0};
  input.rotation_wxyz = {0.5, -0.5, 0.5, -0.5};  // the sensor's z is the body's x, its x the body's -y
  MaskBox box;
  box.min_m = {1.9, 0.0, 0.0};  // at 2 m ahead, the left half
  box.max_m = {2.1, 5.0, 5.0};
  input.body_mask = {box};
  Scan depth = wall_scan(2000);
  EXPECT_EQ(PointFilter(input).apply(depth).own_body, 60u * 41u);  // columns 0 to 40: x <= 0 is the body's left
  EXPECT_EQ(std::get<DepthScan>(depth).depth[40], kNoReturn);
  EXPECT_EQ(std::get<DepthScan>(depth).depth[41], 2000);
  PointScan cloud;
  cloud.xyz_m = {-0.5F, 0.0F, 2.0F, 0.5F, 0.0F, 2.0F, -0.5F, 0.0F, 3.0F};
  Scan points = cloud;
  EXPECT_EQ(PointFilter(input).apply(points).own_body, 1u);
  const auto& xyz = std::get<PointScan>(points).xyz_m;
  EXPECT_TRUE(std::isnan(xyz[0]) && std::isnan(xyz[2]));
  EXPECT_EQ(xyz[3], 0.5F);
  EXPECT_EQ(xyz[8], 3.0F);
}

TEST(PointFilter, PointsBeyondTheGridsReachAreNone) {
  PointScan cloud;
  cloud.xyz_m = {1e30F, 0.0F, 2.0F, 0.0F, -1e6F, 2.0F, 0.0F, 0.0F, 2.0F};
  Scan points = cloud;
  EXPECT_EQ(PointFilter(InputConfig{}).apply(points).out_of_range, 2u);
  EXPECT_TRUE(std::isnan(std::get<PointScan>(points).xyz_m[0]));
  EXPECT_FALSE(std::isnan(std::get<PointScan>(points).xyz_m[8]));
}

TEST(RateLimiter, ThinsThirtyToFifteenDespiteJitter) {
  RateLimiter limiter(15.0, 1.0);
  int passed = 0;
  for (int i = 0; i < 300; ++i) {
    const int jitter_us = (i * 7919) % 3001 - 1500;
    if (limiter.passes(10 * kSecond + i * 33333 + jitter_us)) ++passed;
  }
  EXPECT_EQ(passed, 150);
}

TEST(RateLimiter, NeverExceedsTheRateForLong) {
  RateLimiter limiter(10.0, 1.0);
  int passed = 0;
  for (int i = 0; i < 10000; ++i) passed += limiter.passes(kSecond + i * 1000) ? 1 : 0;  // 1 kHz for 10 s
  EXPECT_GE(passed, 99);
  EXPECT_LE(passed, 101);
}

TEST(RateLimiter, ZeroIsNoLimitAndAStepBackDoesNotSilence) {
  RateLimiter none(0.0, 1.0);
  EXPECT_TRUE(none.passes(1) && none.passes(1) && none.passes(2));
  RateLimiter limiter(1.0, 1.0);
  EXPECT_TRUE(limiter.passes(100 * kSecond));
  EXPECT_FALSE(limiter.passes(100 * kSecond + 1));
  EXPECT_TRUE(limiter.passes(5 * kSecond));
}

TEST(RateLimiter, BeginsAnewWithEachRunOfALoopedLog) {
  RateLimiter limiter(0.1, 1.0);  // one scan in 10 s, of a log of 4 s
  int passed = 0;
  for (int i = 0; i < 120; ++i) passed += limiter.passes(kSecond + (i % 40) * 100000) ? 1 : 0;
  EXPECT_EQ(passed, 3);
}

/// An intake whose scans and warnings are kept.
struct Bench {
  explicit Bench(const ServiceConfig& config = {})
      : intake(
            config, counters, [this](RegisteredScan&& scan) { scans.push_back(std::move(scan)); },
            [this](const std::string& text) { warnings.push_back(text); }) {}
  Counters counters;
  std::vector<RegisteredScan> scans;
  std::vector<std::string> warnings;
  ScanIntake intake;
};

TEST(ScanIntake, ScanAndPoseBecomeARegisteredScan) {
  Bench bench;
  EXPECT_TRUE(bench.intake.on_message("POSE", encoded(pose_message(kSecond, 2.0)), 0.0));
  EXPECT_TRUE(bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond, 1)), 0.0));
  EXPECT_FALSE(bench.intake.on_message("ELSEWHERE", encoded(wall_message(kSecond, 2)), 0.0));
  ASSERT_EQ(bench.scans.size(), 1u);
  EXPECT_EQ(bench.scans[0].T_world_sensor.translation().x(), 2.0);
  EXPECT_EQ(bench.counters.value("scans.received"), 1);
  EXPECT_EQ(bench.counters.value("scans.waiting"), 1);  // for the mapper
  EXPECT_EQ(bench.intake.channels(), (std::vector<std::string>{"PLANEMAP_SCAN", "POSE"}));
}

TEST(ScanIntake, UnknownTypeIsCountedAndSaidOnce) {
  Bench bench;
  auto message = encoded(pose_message(kSecond));
  message[0] ^= 1;
  for (int i = 0; i < 5; ++i) bench.intake.on_message("PLANEMAP_SCAN", message, 100.0 * i);
  EXPECT_EQ(bench.counters.value("scans.rejected.unknown_type"), 5);
  EXPECT_EQ(bench.counters.value("scans.waiting"), 0);
  ASSERT_EQ(bench.warnings.size(), 1u);
  EXPECT_NE(bench.warnings[0].find("channel PLANEMAP_SCAN: fingerprint 0x2f16efb052b0105e is none of"),
            std::string::npos);
}

TEST(ScanIntake, MessagesOnTheWrongChannelAreCountedAndSaidOnce) {
  Bench bench;
  for (int i = 0; i < 5; ++i) {
    bench.intake.on_message("PLANEMAP_SCAN", encoded(pose_message(kSecond)), 100.0 * i);
    bench.intake.on_message("POSE", encoded(wall_message(kSecond, i)), 100.0 * i);
  }
  EXPECT_EQ(bench.counters.value("scans.rejected.wrong_channel"), 5);
  EXPECT_EQ(bench.counters.value("poses.rejected.wrong_channel"), 5);
  ASSERT_EQ(bench.warnings.size(), 2u);
  EXPECT_NE(bench.warnings[0].find("channel PLANEMAP_SCAN: bot_core.pose_t (0x2e16efb052b0105e) is a pose, which "
                                   "belongs on inputs[].pose_channel"),
            std::string::npos);
}

TEST(ScanIntake, RepeatedDamageIsSaidOnceInFiveSeconds) {
  Bench bench;
  auto broken = wall_message(kSecond, 1);
  broken.data[7] ^= 1;
  for (int i = 0; i < 70; ++i) bench.intake.on_message("PLANEMAP_SCAN", encoded(broken), 0.1 * i);
  EXPECT_EQ(bench.counters.value("scans.rejected.checksum"), 70);
  ASSERT_EQ(bench.warnings.size(), 2u);
  EXPECT_NE(bench.warnings[1].find("(50 times since this was said last)"), std::string::npos) << bench.warnings[1];
}

TEST(ScanIntake, SensorsOfSeveralFamiliesWorkAtOnce) {
  ServiceConfig config;
  config.inputs.resize(3);
  config.inputs[0].name = "own";
  config.inputs[1].name = "kinect";
  config.inputs[1].channel = "KINECT_FRAME";
  config.inputs[1].intrinsics = {75.0, 75.0, 40.0, 30.0};
  config.inputs[1].translation_m = {0.0, 0.0, 2.0};
  config.inputs[2].name = "openni";
  config.inputs[2].channel = "OPENNI_FRAME";
  config.inputs[2].family = ScanFamily::kImages;
  config.inputs[2].intrinsics = {80.0, 80.0, 40.0, 30.0, 80.0, 60.0};
  config.inputs[2].pose_channel = "CAMERA_TO_LOCAL";
  config.inputs[2].max_range_m = 0.9;
  Bench bench(config);
  DepthScan wall = wall_scan(1000);
  bench.intake.on_message("POSE", encoded(pose_message(kSecond, 1.0)), 0.0);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = 5.0;
  bench.intake.on_message("CAMERA_TO_LOCAL", encoded(kinect_bridge::to_rigid_transform(T, kSecond)), 0.0);
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond, 1)), 0.0);
  bench.intake.on_message("KINECT_FRAME", encoded(kinect_bridge::to_kinect_frame(wall, kinect_bridge::Encoding::kZlib)),
                          0.0);
  const auto images = encoded(kinect_bridge::to_images(wall, kinect_bridge::Encoding::kZlib));
  bench.intake.on_message("OPENNI_FRAME", images, 0.0);
  ASSERT_EQ(bench.scans.size(), 3u);
  EXPECT_EQ(bench.scans[0].T_world_sensor.translation(), Eigen::Vector3d(1.0, 0.0, 0.0));
  EXPECT_EQ(bench.scans[1].T_world_sensor.translation(), Eigen::Vector3d(1.0, 0.0, 2.0));
  EXPECT_EQ(bench.scans[2].T_world_sensor.translation(), Eigen::Vector3d(5.0, 0.0, 0.0));
  EXPECT_EQ(std::get<DepthScan>(bench.scans[1].scan).intrinsics.fx, 75.0);
  EXPECT_EQ(std::get<DepthScan>(bench.scans[2].scan).intrinsics.fx, 80.0);
  EXPECT_EQ(bench.counters.value("points_out_of_input_range"), 4800);  // of the third, which sees 0.9 m far
  // A good type where another one is wanted.
  bench.intake.on_message("OPENNI_FRAME", encoded(wall_message(kSecond, 2)), 0.0);
  EXPECT_EQ(bench.counters.value("scans.rejected.wrong_channel"), 1);
  // No intrinsics: said, counted, and the daemon goes on.
  bench.intake.on_message("PLANEMAP_SCAN", images, 0.0);
  EXPECT_EQ(bench.counters.value("scans.rejected.intrinsics"), 1);
  EXPECT_EQ(bench.intake.last_problem().rfind("PLANEMAP_SCAN: images_t brings no intrinsics", 0), 0u)
      << bench.intake.last_problem();
  EXPECT_EQ(bench.counters.value("scans.received"), 5);
  EXPECT_EQ(bench.counters.value("scans.waiting"), 3);
}

TEST(ScanIntake, DuplicatesAndTooFastScansAreDroppedByName) {
  ServiceConfig config;
  config.inputs[0].max_rate_hz = 10.0;
  Bench bench(config);
  const auto first = encoded(wall_message(kSecond, 1));
  bench.intake.on_message("PLANEMAP_SCAN", first, 0.0);
  bench.intake.on_message("PLANEMAP_SCAN", first, 0.0);
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond + 33333, 2)), 0.0);
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond + 100000, 6)), 0.0);
  EXPECT_EQ(bench.counters.value("scans.dropped.duplicate"), 1);
  EXPECT_EQ(bench.counters.value("scans.dropped.rate_limit"), 1);
  EXPECT_EQ(bench.counters.value("scans.waiting"), 2);
  EXPECT_EQ(bench.counters.value("scans_lost_before_arrival.kinect"), 3);  // numbers 3 to 5
}

TEST(ScanIntake, PosesAreCountedByWhatBecameOfThem) {
  Bench bench;
  const auto send = [&](const bot_core::pose_t& pose) { bench.intake.on_message("POSE", encoded(pose), 0.0); };
  send(pose_message(100 * kSecond));
  send(pose_message(100 * kSecond + 100000));
  send(pose_message(100 * kSecond + 50000));
  send(pose_message(100 * kSecond + 50000));
  send(pose_message(100 * kSecond + 200000, 5.0));
  send(pose_message(20 * kSecond));
  auto bad = pose_message(20 * kSecond);
  bad.orientation[0] = 0.0;
  send(bad);
  EXPECT_EQ(bench.counters.value("poses.received"), 7);
  EXPECT_EQ(bench.counters.value("poses.out_of_order"), 1);
  EXPECT_EQ(bench.counters.value("poses.duplicate"), 1);
  EXPECT_EQ(bench.counters.value("poses.jumps"), 1);
  EXPECT_EQ(bench.counters.value("poses.restarts"), 1);
  EXPECT_EQ(bench.counters.value("poses.rejected.quaternion"), 1);
}

TEST(ScanIntake, PosesThatStateTheirCovarianceAreCounted) {
  Bench bench;
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond, 1)), 0.0);
  bench.intake.on_message("POSE", encoded(pose_cov_message(kSecond, 1.5, 0.01, 0.002)), 0.0);
  bench.intake.on_message("POSE", encoded(pose_message(kSecond + 100000, 1.5)), 0.0);
  bench.intake.on_message("POSE", encoded(pose_cov_message(kSecond + 200000, 1.5, 0.0, 0.0)), 0.0);  // states none
  EXPECT_EQ(bench.counters.value("poses.received"), 3);
  EXPECT_EQ(bench.counters.value("poses.with_covariance"), 1);
  ASSERT_EQ(bench.scans.size(), 1u);
  EXPECT_EQ(bench.scans[0].T_world_sensor.translation().x(), 1.5);
  EXPECT_NEAR(bench.scans[0].pose_covariance.value()(0, 0), 1e-4, 1e-15);
  EXPECT_NEAR(bench.scans[0].pose_covariance.value()(3, 3), 4e-6, 1e-15);
}

TEST(ScanIntake, ItIsSaidOnceThatErrorsOfPosesLastForNoTime) {
  for (const double correlation_s : {0.0, 2.0}) {
    ServiceConfig config;
    config.pose.error.correlation_s = correlation_s;
    Bench bench(config);
    for (int i = 0; i < 3; ++i) {
      bench.intake.on_message("POSE", encoded(pose_cov_message(kSecond + i * 100000, 0.0, 0.01, 0.002)), 100.0 * i);
    }
    ASSERT_EQ(bench.warnings.size(), correlation_s > 0.0 ? 0u : 1u);
    if (!bench.warnings.empty()) {
      EXPECT_NE(bench.warnings[0].find("pose.correlation_s = 0"), std::string::npos);
    }
  }
}

TEST(ScanIntake, APoseThatIsTooUncertainIsTheReasonForBeingIdle) {
  Bench bench;
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond, 1)), 100.0);
  bench.intake.on_message("POSE", encoded(pose_cov_message(kSecond, 0.0, 1000.0, 0.002)), 100.0);
  EXPECT_EQ(bench.counters.value("poses.rejected.uncertain"), 1);
  EXPECT_EQ(
      idle_reason(bench.intake.facts(), MapperFacts{}, 101.0),
      "POSE: rigid_body_pose_cov_t: the pose may be off by 1e+03 m and 0.002 rad (one sigma; up to 10 m and 1 rad "
      "are mapped)");
}

TEST(ScanIntake, AShortLogMayBeReplayedInALoop) {
  Bench bench;
  for (int run = 0; run < 3; ++run) {
    for (int i = 0; i < 20; ++i) {  // 2 s, less than the poses that are kept
      const std::int64_t utime = 100 * kSecond + i * 100000;
      bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(utime, i)), 0.0);
      bench.intake.on_message("POSE", encoded(pose_message(utime, 0.01 * i)), 0.0);
    }
  }
  EXPECT_EQ(bench.counters.value("poses.restarts"), 2);
  EXPECT_EQ(bench.counters.value("poses.duplicate") + bench.counters.value("poses.out_of_order"), 0);
  EXPECT_EQ(bench.counters.value("poses.jumps"), 0);
  EXPECT_EQ(bench.counters.value("scans.dropped.duplicate"), 0);
  ASSERT_EQ(bench.scans.size(), 60u);
  for (std::size_t k = 0; k < 60; ++k) {
    EXPECT_NEAR(bench.scans[k].T_world_sensor.translation().x(), 0.01 * static_cast<double>(k % 20), 1e-12) << k;
  }
}

TEST(ScanIntake, AJumpIsSaidWithWhatBecomesOfTheMap) {
  ServiceConfig config;
  for (const auto& [jump, said] : std::map<std::string, std::string>{
           {"continue", "the pose on POSE jumped; the map goes on, and may hold things twice"},
           {"reset", "the pose on POSE jumped; a new map begins with the scans after it"}}) {
    config.pose.jump = jump;
    Bench bench(config);
    for (const double x_m : {0.0, 5.0}) {
      const std::int64_t utime = kSecond + std::llround(10000 * x_m);
      bench.intake.on_message("POSE", encoded(pose_message(utime, x_m)), 0.0);
      bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(utime, 1)), 0.0);
    }
    EXPECT_EQ(bench.counters.value("poses.jumps"), 1);
    EXPECT_EQ(bench.warnings, (std::vector<std::string>{said}));
    ASSERT_EQ(bench.scans.size(), 2u);
    EXPECT_EQ(bench.scans[1].map_number, jump == "reset" ? 1u : 0u);
  }
}

TEST(ScanIntake, FinishLetsNothingWait) {
  Bench bench;
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond, 1)), 0.0);
  bench.intake.finish();
  EXPECT_EQ(bench.counters.value("scans.dropped.no_pose"), 1);
  EXPECT_EQ(bench.counters.value("scans.waiting"), 0);
  EXPECT_EQ(bench.intake.last_problem(), "no pose on POSE yet (scan at 1.000000)");
}

InputFacts default_facts() {
  InputFacts facts;
  facts.channel = "PLANEMAP_SCAN";
  facts.pose_channel = "POSE";
  return facts;
}

TEST(IdleReason, SaysWhatIsMissing) {
  InputFacts facts = default_facts();
  const auto reason = [&](double now_s) { return idle_reason(std::span(&facts, 1), MapperFacts{}, now_s); };
  EXPECT_EQ(reason(10.0), "no scan on PLANEMAP_SCAN yet");
  facts.scans = 3;
  facts.last_scan_host_s = 10.0;
  EXPECT_EQ(reason(10.1), "no pose on POSE yet");
  facts.poses = 2;
  facts.last_pose_host_s = 4.0;
  facts.last_problem = "no pose within 0.5 s of scan at 11.000000; last pose on POSE at 10.000000";
  facts.last_problem_host_s = 10.0;
  EXPECT_EQ(reason(10.1), facts.last_problem);
  EXPECT_EQ(reason(30.0), "no scan on PLANEMAP_SCAN for 20 s");
}

TEST(IdleReason, DamagedMessagesAreTheReasonNotSilence) {
  InputFacts facts = default_facts();
  facts.last_problem = "PLANEMAP_SCAN: depth_scan_t: crc32 is wrong";
  facts.last_problem_host_s = 9.0;
  EXPECT_EQ(idle_reason(std::span(&facts, 1), MapperFacts{}, 10.0), facts.last_problem);
  facts = default_facts();
  facts.scans = 1;
  facts.last_scan_host_s = 9.9;
  facts.last_pose_problem = "POSE: pose_t: orientation has length 0";
  facts.last_pose_problem_host_s = 9.9;
  EXPECT_EQ(idle_reason(std::span(&facts, 1), MapperFacts{}, 10.0), facts.last_pose_problem);
}

TEST(IdleReason, NoneWhileScansAreMapped) {
  const InputFacts facts = default_facts();
  MapperFacts mapper;
  mapper.mapped = 5;
  mapper.last_mapped_host_s = 9.0;
  EXPECT_EQ(idle_reason(std::span(&facts, 1), mapper, 10.0), "");
  EXPECT_NE(idle_reason(std::span(&facts, 1), mapper, 12.5), "");
}

/// Scans that get their poses and reach the mapper.
InputFacts facts_of_a_sound_input() {
  InputFacts facts = default_facts();
  facts.scans = facts.poses = facts.handed_on = 100;
  facts.last_scan_host_s = facts.last_pose_host_s = facts.last_handed_on_host_s = 19.9;
  facts.last_problem = "no pose within 0.5 s of scan at 11.000000; last pose on POSE at 10.000000";
  facts.last_problem_host_s = 2.0;  // long ago
  return facts;
}

TEST(IdleReason, NamesTheMapperWhereScansReachIt) {
  const InputFacts facts = facts_of_a_sound_input();
  const auto reason = [&](const MapperFacts& mapper) { return idle_reason(std::span(&facts, 1), mapper, 20.0); };
  MapperFacts mapper;
  mapper.mapped = 3;
  mapper.last_mapped_host_s = 8.0;
  EXPECT_EQ(reason(mapper), "the scans on PLANEMAP_SCAN are on their way to the mapper");
  mapper.queued = 4;
  mapper.queue_capacity = 16;
  mapper.busy_since_host_s = 19.0;
  EXPECT_EQ(reason(mapper), "4 scans wait for the mapper");
  mapper.busy_since_host_s = 8.0;
  EXPECT_EQ(reason(mapper), "the mapper has been busy with one scan for 12 s; 4 scans wait for the mapper");
  mapper.dropped_from_full_queue = 7;
  mapper.last_dropped_host_s = 19.5;
  EXPECT_EQ(reason(mapper),
            "the mapper has been busy with one scan for 12 s; "
            "the mapper cannot keep up: 7 scans were dropped from its full queue (queue.scans = 16)");
  mapper = MapperFacts{};
  mapper.last_error = "the scan at utime 5 could not be mapped: no memory";
  mapper.last_error_host_s = 19.0;
  EXPECT_EQ(reason(mapper), mapper.last_error);
}

TEST(IdleReason, NamesBothAMapperThatHangsAndAnInputWithoutPoses) {
  std::vector<InputFacts> facts = {facts_of_a_sound_input(), default_facts()};
  facts[1].channel = "BACK";
  facts[1].pose_channel = "BACK_POSE";
  facts[1].scans = 5;
  facts[1].last_scan_host_s = 19.9;
  MapperFacts mapper;
  mapper.queued = 2;
  EXPECT_EQ(idle_reason(facts, mapper, 20.0), "2 scans wait for the mapper; no pose on BACK_POSE yet");
}

TEST(IdleReason, CountsOnlyScansThatDoWaitForAPose) {
  InputFacts facts = facts_of_a_sound_input();
  facts.last_handed_on_host_s = 2.0;
  facts.waiting = 3;
  EXPECT_EQ(idle_reason(std::span(&facts, 1), MapperFacts{}, 20.0), "3 scans on PLANEMAP_SCAN wait for a pose on POSE");
  facts.waiting = 0;
  facts.last_left_out = "the same scan comes on PLANEMAP_SCAN again and again";
  facts.last_left_out_host_s = 19.0;
  EXPECT_EQ(idle_reason(std::span(&facts, 1), MapperFacts{}, 20.0), facts.last_left_out);
}

TEST(ScanIntake, FactsSayWhatReachesTheMapperAndWhatIsLeftOut) {
  ServiceConfig config;
  config.inputs[0].max_rate_hz = 0.5;
  Bench bench(config);
  bench.intake.on_message("POSE", encoded(pose_message(kSecond)), 4.0);
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond, 1)), 5.0);
  InputFacts facts = bench.intake.facts().at(0);
  EXPECT_EQ(facts.handed_on, 1);
  EXPECT_EQ(facts.last_handed_on_host_s, 5.0);
  EXPECT_EQ(facts.last_left_out, "");
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond, 1)), 6.0);
  EXPECT_EQ(bench.intake.facts().at(0).last_left_out, "the same scan comes on PLANEMAP_SCAN again and again");
  bench.intake.on_message("PLANEMAP_SCAN", encoded(wall_message(kSecond + 1, 2)), 7.0);
  facts = bench.intake.facts().at(0);
  EXPECT_EQ(facts.last_left_out, "max_rate_hz = 0.5 lets no scan on PLANEMAP_SCAN pass yet");
  EXPECT_EQ(facts.last_left_out_host_s, 7.0);
  EXPECT_EQ(facts.handed_on, 1);
}

TEST(IdleReason, NamesEveryInput) {
  std::vector<InputFacts> facts = {default_facts(), default_facts()};
  facts[1].channel = "BACK";
  EXPECT_EQ(idle_reason(facts, MapperFacts{}, 1.0), "no scan on PLANEMAP_SCAN yet; no scan on BACK yet");
}

TEST(KernelDrops, SumsTheDropsOfOurSockets) {
  const char* table =
      "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode ref pointer "
      "drops\n"
      "  112: 00000000:1DF3 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 5001 2 "
      "0000000000000000 17\n"
      "  113: 00000000:1DF3 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 5002 2 "
      "0000000000000000 4\n"
      "  114: 00000000:1DF3 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 5003 2 "
      "0000000000000000 900\n"
      "  115: cut short\n";
  EXPECT_EQ(udp_drops(table, {5001, 5002, 7777}), 21);
  EXPECT_EQ(udp_drops(table, {}), 0);
  EXPECT_EQ(udp_drops("", {5001}), 0);
  EXPECT_GE(KernelDrops().count(), 0);
}

TEST(KernelDrops, AdviceSaysWhatToRun) {
  const std::string url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152";
  EXPECT_NE(receive_buffer_advice(url, "212992\n").find("sysctl -w net.core.rmem_max=2097152"), std::string::npos);
  EXPECT_EQ(receive_buffer_advice(url, "2097152\n"), "");
  EXPECT_EQ(receive_buffer_advice(url, ""), "");
  EXPECT_EQ(receive_buffer_advice("memq://", "212992\n"), "");
}

}  // namespace
}  // namespace planemap::service

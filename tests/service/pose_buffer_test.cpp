#include "sync/pose_buffer.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

namespace planemap::service {
namespace {

constexpr std::int64_t kSecond = 1000000;

StampedPose pose_at(std::int64_t utime, double x_m, double yaw_rad = 0.0) {
  return {utime, {x_m, 0.0, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()))};
}

TEST(PoseBuffer, InterpolatesPositionAndRotation) {
  PoseBuffer poses{PoseConfig{}};
  poses.insert(pose_at(10 * kSecond, 1.0, 0.0));
  poses.insert(pose_at(10 * kSecond + 400000, 1.8, 0.4));
  const auto pose = poses.find(10 * kSecond + 100000);  // a quarter of the way
  ASSERT_EQ(pose.match, PoseMatch::kFound);
  EXPECT_NEAR(pose.T_world_body.translation().x(), 1.2, 1e-12);
  const Eigen::AngleAxisd turn(pose.T_world_body.rotation());
  EXPECT_NEAR(turn.angle(), 0.1, 1e-12);
}

TEST(PoseBuffer, TakesTheShortWayBetweenOppositeQuaternions) {
  PoseBuffer poses{PoseConfig{}};
  auto a = pose_at(kSecond, 0.0, 0.0);
  auto b = pose_at(kSecond + 200000, 0.0, 0.2);
  b.q_world_body.coeffs() *= -1.0;  // the same rotation
  poses.insert(a);
  EXPECT_EQ(poses.insert(b), PoseInsert::kAppended);  // and no jump
  const Eigen::AngleAxisd turn(poses.find(kSecond + 100000).T_world_body.rotation());
  EXPECT_NEAR(turn.angle(), 0.1, 1e-12);
}

TEST(PoseBuffer, CovariancesAreInterpolatedToo) {
  PoseBuffer poses{PoseConfig{}};
  auto a = pose_at(kSecond, 0.0);
  auto b = pose_at(kSecond + 400000, 0.0);
  a.covariance = PoseCovariance::Identity() * 4e-6;
  b.covariance = PoseCovariance::Identity() * 16e-6;
  (*b.covariance)(0, 5) = (*b.covariance)(5, 0) = 8e-6;
  poses.insert(a);
  poses.insert(b);
  const auto at = [&](std::int64_t offset_us) { return poses.find(kSecond + offset_us).covariance.value(); };
  PoseCovariance quarter = PoseCovariance::Identity() * 7e-6;
  quarter(0, 5) = quarter(5, 0) = 2e-6;
  EXPECT_TRUE(at(100000).isApprox(quarter, 1e-12)) << at(100000);
  EXPECT_EQ(at(0), *a.covariance);
  EXPECT_EQ(at(400000), *b.covariance);
  EXPECT_EQ(at(400500), *b.covariance);  // near enough
}

TEST(PoseBuffer, ErrorsOfPositionKeepToTheWorldsAxesWhereTheBodyTurns) {
  // Both poses are unsure along the world's x alone; the body turns from yaw 0 to 0.6.
  PoseBuffer poses{PoseConfig{}};
  auto a = pose_at(kSecond, 0.0, 0.0);
  auto b = pose_at(kSecond + 400000, 0.0, 0.6);
  for (auto* pose : {&a, &b}) {
    const Eigen::Vector3d x_body = pose->q_world_body.conjugate() * Eigen::Vector3d::UnitX();
    pose->covariance = PoseCovariance::Zero();
    pose->covariance->topLeftCorner<3, 3>() = 9e-6 * x_body * x_body.transpose();
    poses.insert(*pose);
  }
  const auto pose = poses.find(kSecond + 100000);
  const Eigen::Matrix3d R = pose.T_world_body.linear();
  const Eigen::Matrix3d in_world = R * pose.covariance.value().topLeftCorner<3, 3>() * R.transpose();
  EXPECT_TRUE(in_world.isApprox(Eigen::Vector3d(9e-6, 0.0, 0.0).asDiagonal().toDenseMatrix(), 1e-12)) << in_world;
}

TEST(PoseBuffer, WhereOnePoseStatesNoCovarianceThatOfTheOtherStandsForBoth) {
  for (const bool first : {true, false}) {
    PoseBuffer poses{PoseConfig{}};
    auto a = pose_at(kSecond, 0.0);
    auto b = pose_at(kSecond + 400000, 0.0);
    (first ? a : b).covariance = PoseCovariance::Identity();
    poses.insert(a);
    poses.insert(b);
    EXPECT_TRUE(poses.find(kSecond + 100000).covariance.value().isApprox(PoseCovariance::Identity(), 1e-12));
  }
  PoseBuffer poses{PoseConfig{}};
  poses.insert(pose_at(kSecond, 0.0));
  poses.insert(pose_at(kSecond + 400000, 0.0));
  EXPECT_FALSE(poses.find(kSecond + 100000).covariance);
}

TEST(PoseBuffer, SaysWhyThereIsNoPose) {
  PoseBuffer poses{PoseConfig{}};
  EXPECT_EQ(poses.find(kSecond).match, PoseMatch::kNoneYet);
  poses.insert(pose_at(10 * kSecond, 0.0));
  EXPECT_EQ(poses.find(10 * kSecond - 1001).match, PoseMatch::kBefore);
  EXPECT_EQ(poses.find(10 * kSecond + 1001).match, PoseMatch::kNotYet);
  poses.insert(pose_at(10 * kSecond + 500001, 0.0));
  const auto gap = poses.find(10 * kSecond + 250000);
  EXPECT_EQ(gap.match, PoseMatch::kGap);
  EXPECT_NEAR(gap.gap_s, 0.500001, 1e-12);
}

TEST(PoseBuffer, PoseWithinAMillisecondNeedsNoOther) {
  PoseBuffer poses{PoseConfig{}};
  poses.insert(pose_at(10 * kSecond, 3.0));
  for (const std::int64_t offset_us : {-1000, -1, 0, 1, 1000}) {
    const auto pose = poses.find(10 * kSecond + offset_us);
    ASSERT_EQ(pose.match, PoseMatch::kFound) << offset_us;
    EXPECT_EQ(pose.T_world_body.translation().x(), 3.0);
  }
  poses.insert(pose_at(12 * kSecond, 5.0));  // beyond the gap: near the ends of it the poses still count
  EXPECT_EQ(poses.find(10 * kSecond + 900).T_world_body.translation().x(), 3.0);
  EXPECT_EQ(poses.find(12 * kSecond - 900).T_world_body.translation().x(), 5.0);
  EXPECT_EQ(poses.find(11 * kSecond).match, PoseMatch::kGap);
}

TEST(PoseBuffer, SortsWhatComesOutOfOrder) {
  PoseBuffer poses{PoseConfig{}};
  EXPECT_EQ(poses.insert(pose_at(1000000, 1.0)), PoseInsert::kAppended);
  EXPECT_EQ(poses.insert(pose_at(1200000, 1.2)), PoseInsert::kAppended);
  EXPECT_EQ(poses.insert(pose_at(1100000, 0.5)), PoseInsert::kOutOfOrder);
  EXPECT_EQ(poses.insert(pose_at(900000, 0.9)), PoseInsert::kOutOfOrder);
  EXPECT_EQ(poses.insert(pose_at(1100000, 9.9)), PoseInsert::kDuplicate);
  EXPECT_EQ(poses.size(), 4u);
  EXPECT_EQ(poses.oldest_utime(), 900000);
  EXPECT_NEAR(poses.find(1050000).T_world_body.translation().x(), 0.75, 1e-12);
  EXPECT_EQ(poses.find(1100000).T_world_body.translation().x(), 0.5);
}

TEST(PoseBuffer, ForgetsWhatIsOlderThanItsHistory) {
  PoseBuffer poses{PoseConfig{}};  // ten seconds
  for (int i = 0; i <= 300; ++i) poses.insert(pose_at(kSecond + i * 100000, 0.1 * i));
  EXPECT_EQ(poses.newest_utime() - poses.oldest_utime(), 10 * kSecond);
  EXPECT_EQ(poses.size(), 101u);
}

TEST(PoseBuffer, AFloodOfPosesIsBounded) {
  PoseBuffer poses{PoseConfig{}};
  for (int i = 0; i < 150000; ++i) poses.insert(pose_at(kSecond + i, 0.0));
  EXPECT_EQ(poses.size(), 100000u);
  EXPECT_EQ(poses.insert(pose_at(kSecond, 0.0)), PoseInsert::kTooOld);
}

TEST(PoseBuffer, AStepBackBeyondALateArrivalIsOneRestart) {
  PoseBuffer poses{PoseConfig{}};
  poses.insert(pose_at(100 * kSecond, 0.0));
  poses.insert(pose_at(100 * kSecond + 100000, 0.0));
  EXPECT_EQ(poses.insert(pose_at(5 * kSecond, 2.0)), PoseInsert::kRestarted);
  EXPECT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses.insert(pose_at(5 * kSecond + 100000, 2.0)), PoseInsert::kAppended);
  EXPECT_EQ(poses.find(5 * kSecond + 50000).match, PoseMatch::kFound);
}

TEST(PoseBuffer, AStepBackByASecondIsALateArrival) {
  PoseBuffer poses{PoseConfig{}};
  poses.insert(pose_at(10 * kSecond, 1.0));
  EXPECT_EQ(poses.insert(pose_at(9 * kSecond, 0.9)), PoseInsert::kOutOfOrder);
  EXPECT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses.insert(pose_at(9 * kSecond - 1, 0.9)), PoseInsert::kRestarted);
  EXPECT_EQ(poses.size(), 1u);
}

TEST(PoseBuffer, ALogShorterThanTheHistoryMayBeReplayedInALoop) {
  PoseBuffer poses{PoseConfig{}};
  std::map<PoseInsert, int> results;
  for (int run = 0; run < 3; ++run) {
    for (int i = 0; i < 40; ++i) ++results[poses.insert(pose_at(kSecond + i * 100000, 0.1 * i))];  // 4 of 10 s
    EXPECT_EQ(poses.size(), 40u);
  }
  EXPECT_EQ(results, (std::map<PoseInsert, int>{{PoseInsert::kAppended, 118}, {PoseInsert::kRestarted, 2}}));
}

TEST(PoseBuffer, LookupsSayHowManyJumpsWereBefore) {
  PoseBuffer poses{PoseConfig{}};
  poses.insert(pose_at(1000000, 0.0));
  poses.insert(pose_at(1100000, 0.1));
  poses.insert(pose_at(1300000, 7.0));  // a jump
  poses.insert(pose_at(1400000, 7.1));
  EXPECT_EQ(poses.find(1050000).jumps, 0u);
  EXPECT_EQ(poses.find(1100900).jumps, 0u);  // near the last pose before it
  EXPECT_EQ(poses.find(1299100).jumps, 1u);  // near the first pose behind it
  EXPECT_EQ(poses.find(1350000).jumps, 1u);
  // Late poses belong to their side of it.
  EXPECT_EQ(poses.insert(pose_at(1150000, 0.2)), PoseInsert::kOutOfOrder);
  EXPECT_EQ(poses.insert(pose_at(1250000, 7.0)), PoseInsert::kOutOfOrder);
  EXPECT_EQ(poses.find(1125000).jumps, 0u);
  EXPECT_EQ(poses.find(1275000).jumps, 1u);
  EXPECT_EQ(poses.find(1200000).match, PoseMatch::kJump);
  // A restart of the clock is no jump, and forgets none.
  poses.insert(pose_at(100000, 0.0));
  EXPECT_EQ(poses.find(100000).jumps, 1u);
}

TEST(PoseBuffer, NobodyKnowsWhereTheBodyWasDuringAJump) {
  PoseBuffer poses{PoseConfig{}};  // 1 m, 45 degrees
  poses.insert(pose_at(1000000, 0.0));
  EXPECT_EQ(poses.insert(pose_at(1100000, 0.99)), PoseInsert::kAppended);
  EXPECT_EQ(poses.insert(pose_at(1200000, 2.0)), PoseInsert::kJumped);
  EXPECT_EQ(poses.insert(pose_at(1300000, 2.0, 46.0 * std::numbers::pi / 180.0)), PoseInsert::kJumped);
  EXPECT_EQ(poses.find(1050000).match, PoseMatch::kFound);
  EXPECT_EQ(poses.find(1150000).match, PoseMatch::kJump);
  EXPECT_EQ(poses.find(1250000).match, PoseMatch::kJump);
  EXPECT_EQ(poses.find(1200000).match, PoseMatch::kFound);
  // Half a minute later it may well be elsewhere.
  EXPECT_EQ(poses.insert(pose_at(9 * kSecond, 9.0)), PoseInsert::kAppended);
}

}  // namespace
}  // namespace planemap::service

#include "planemap/pose_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A sensor above a place, that looks straight down at the plane z = 0.
ScanPose looking_down(double x_m, double y_m, double height_m, double time_s) {
  ScanPose scan;
  scan.T_world_sensor.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  scan.T_world_sensor.translation() = Vector3d(x_m, y_m, height_m);
  scan.utime = std::llround(1e6 * time_s);
  return scan;
}

/// A grid of points on z = 0, 2 m along x and 1 m along y.
std::vector<Vector3d> patch(double x_m, double y_m) {
  std::vector<Vector3d> points;
  for (double u = -1.0; u <= 1.0; u += 0.1) {
    for (double v = -0.5; v <= 0.5; v += 0.1) points.emplace_back(x_m + u, y_m + v, 0.0);
  }
  return points;
}

Moments moments_of(const std::vector<Vector3d>& points, const Vector3d& origin_m) {
  Moments moments;
  for (const Vector3d& p : points) moments.add(Moments{1.0, p - origin_m, Symmetric3::outer(p - origin_m)});
  return moments;
}

/// A plane's evidence and what its poses make of it, scan by scan.
struct SeenPlane {
  Vector3d origin_m = Vector3d::Zero();
  Moments held{};
  PoseEvidence evidence{};

  /// Takes in what a scan saw, or with a factor below 0 what left the plane after it.
  void see(const std::vector<Vector3d>& points, const ScanPose& scan, const PoseErrorConfig& config,
           double times = 1.0) {
    held.add(moments_of(points, origin_m), times, Vector3d::Zero());
    evidence.update(held, Vector3d::UnitZ(), origin_m, scan, config);
  }
};

/// The fit to points on z = 0: tangent_1 is y, the direction of less spread, and tangent_2 is x.
PlaneFit fit_of(const std::vector<Vector3d>& points) {
  const Moments moments = moments_of(points, Vector3d::Zero());
  PlaneFit fit;
  fit.centroid_m = moments.mean();
  fit.tangent_1 = Vector3d::UnitY();
  fit.tangent_2 = Vector3d::UnitX();
  fit.spread_1_m2 = moments.covariance()(1, 1);
  fit.spread_2_m2 = moments.covariance()(0, 0);
  fit.weight = moments.weight;
  return fit;
}

PoseErrorConfig errors(double sigma_m, double sigma_rad, double correlation_s) {
  PoseErrorConfig config;
  config.sigma_m = sigma_m;
  config.sigma_rad = sigma_rad;
  config.correlation_s = correlation_s;
  return config;
}

/// One look after another at the same patch, from straight above it.
Matrix3d covariance_of_looks(const std::vector<double>& times_s, const PoseErrorConfig& config) {
  const auto points = patch(0.0, 0.0);
  SeenPlane plane;
  for (const double time_s : times_s) plane.see(points, looking_down(0.0, 0.0, 2.0, time_s), config);
  return plane.evidence.covariance(fit_of(points), Vector3d::Zero(), configured_covariance(config));
}

TEST(PoseEvidence, OneScanIsAsWrongAsItsPose) {
  // Seen from straight above its middle: a wrong height moves the plane by as much, a wrong rotation turns it by as
  // much.
  const Matrix3d c = covariance_of_looks({1.0}, errors(0.003, 0.002, 0.0));
  EXPECT_TRUE(c.isApprox(Vector3d(4e-6, 4e-6, 9e-6).asDiagonal().toDenseMatrix(), 1e-9)) << c;
}

TEST(PoseEvidence, ScansShareTheirErrorsByTheTimeBetweenThem) {
  const double half_s = 10.0 * std::log(2.0);  // then exp(-dt / 10 s) = 1/2
  EXPECT_NEAR(covariance_of_looks({0.0, 1.0}, errors(0.01, 0.0, 0.0))(2, 2), 0.5e-4, 1e-12);      // 1/2 (1 + 0)
  EXPECT_NEAR(covariance_of_looks({0.0, half_s}, errors(0.01, 0.0, 10.0))(2, 2), 0.75e-4, 1e-9);  // 1/2 (1 + 1/2)
  // 1/9 (3 + 2 (1/2 + 1/2 + 1/4))
  EXPECT_NEAR(covariance_of_looks({0.0, half_s, 2.0 * half_s}, errors(0.01, 0.0, 10.0))(2, 2), 5.5e-4 / 9.0, 1e-9);
}

TEST(PoseEvidence, TwentyScansOfOneLookAreHardlyMoreThanOne) {
  std::vector<double> times_s;
  for (int i = 0; i < 20; ++i) times_s.push_back(i / 30.0);
  EXPECT_GT(covariance_of_looks(times_s, errors(0.01, 0.0, 10.0))(2, 2), 0.95e-4);
}

/// A walk along a strip.
struct Walk {
  static constexpr double kStepS = 0.5;
  std::vector<ScanPose> scans;
  std::vector<std::vector<Vector3d>> seen;  ///< by scan
  std::vector<Vector3d> all;
};
Walk walk(int steps) {
  Walk walk;
  for (int k = 0; k < steps; ++k) {
    const double x_m = 0.08 * k;
    walk.scans.push_back(looking_down(x_m - 1.0, 0.3, 2.0 + 0.01 * k, Walk::kStepS * k));
    walk.seen.push_back(patch(x_m, 0.0));
    walk.all.insert(walk.all.end(), walk.seen.back().begin(), walk.seen.back().end());
  }
  return walk;
}

Matrix3d stated_covariance(const Walk& walk, const PlaneFit& fit, const PoseErrorConfig& config) {
  const Vector3d origin_m(0.7, -0.4, 0.0);
  SeenPlane plane{origin_m};
  for (std::size_t k = 0; k < walk.scans.size(); ++k) plane.see(walk.seen[k], walk.scans[k], config);
  return plane.evidence.covariance(fit, origin_m, configured_covariance(config));
}

/// The scans' poses are disturbed as wholes, point by point, again and again, and the plane is fitted to all points.
Matrix3d scatter_of_fits(const Walk& walk, const PlaneFit& fit, const PoseErrorConfig& config) {
  constexpr int kTrials = 600;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Matrix3d equations = Matrix3d::Zero();
  const auto row = [&](const Vector3d& p) {
    return Vector3d(p.y() - fit.centroid_m.y(), p.x() - fit.centroid_m.x(), 1.0);
  };
  for (const Vector3d& p : walk.all) equations += row(p) * row(p).transpose();
  Matrix3d scatter = Matrix3d::Zero();
  const double kept = std::exp(-Walk::kStepS / config.correlation_s);
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::Matrix<double, 6, 1> state;
    for (double& value : state) value = normal(random);
    Vector3d heights = Vector3d::Zero();
    for (std::size_t k = 0; k < walk.scans.size(); ++k) {
      const Isometry3d& T = walk.scans[k].T_world_sensor;
      const Eigen::Matrix<double, 6, 1> x = cholesky_factor(walk.scans[k].covariance_or(config)) * state;
      const Vector3d rotation = x.tail<3>();
      Isometry3d error = Isometry3d::Identity();
      error.translation() = x.head<3>();
      error.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
      const Isometry3d disturbed = T * error * T.inverse();
      for (const Vector3d& p : walk.seen[k]) heights += row(p) * (disturbed * p).z();
      for (double& value : state) value = kept * value + std::sqrt(1.0 - kept * kept) * normal(random);
    }
    const Vector3d estimate = equations.inverse() * heights;
    scatter += estimate * estimate.transpose() / kTrials;
  }
  return scatter;
}

void expect_same_covariance(const Matrix3d& stated, const Matrix3d& scatter) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(std::sqrt(stated(i, i) / scatter(i, i)), 1.0, 0.1) << i;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    EXPECT_NEAR(stated(i, j) / std::sqrt(stated(i, i) * stated(j, j)),
                scatter(i, j) / std::sqrt(scatter(i, i) * scatter(j, j)), 0.12)
        << i << j;
  }
}

TEST(PoseEvidence, IsTheScatterOfFitsWithWanderingPoses) {
  const PoseErrorConfig config = errors(0.004, 0.002, 3.0);
  const Walk strip = walk(40);
  const PlaneFit fit = fit_of(strip.all);
  expect_same_covariance(stated_covariance(strip, fit, config), scatter_of_fits(strip, fit, config));
}

TEST(PoseEvidence, IsTheScatterOfFitsWhereEachPoseHasACovarianceOfItsOwn) {
  // From one covariance to another that is five times as large, all errors correlated, some scans without.
  std::mt19937_64 random(12);
  std::normal_distribution<double> normal;
  PoseCovariance first;
  PoseCovariance last;
  for (double& value : first.reshaped()) value = 0.001 * normal(random);
  for (double& value : last.reshaped()) value = 0.005 * normal(random);
  Walk strip = walk(40);
  for (std::size_t k = 0; k < strip.scans.size(); ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(strip.scans.size());
    if (k % 7 == 3) continue;
    strip.scans[k].covariance = (1.0 - share) * first * first.transpose() + share * last * last.transpose();
  }
  const PoseErrorConfig config = errors(0.004, 0.002, 3.0);
  const PlaneFit fit = fit_of(strip.all);
  const Matrix3d stated = stated_covariance(strip, fit, config);
  expect_same_covariance(stated, scatter_of_fits(strip, fit, config));
  Walk without = walk(40);
  EXPECT_GT(stated(2, 2), 1.5 * stated_covariance(without, fit, config)(2, 2)) << "else this shows nothing";
}

TEST(PoseEvidence, AScanIsAsWrongAsItSaysOfItself) {
  // 3 mm along the sensor's z, which points down, and 2 mrad about its x, which is that of the world, correlated by
  // 1/2: a plane that is seen too low rises with y.
  ScanPose scan = looking_down(0.0, 0.0, 2.0, 1.0);
  PoseCovariance x = PoseCovariance::Zero();
  x(2, 2) = 9e-6;
  x(3, 3) = 4e-6;
  x(2, 3) = x(3, 2) = 3e-6;
  scan.covariance = x;
  const auto points = patch(0.0, 0.0);
  SeenPlane plane;
  plane.see(points, scan, errors(1.0, 1.0, 1.0));
  const Matrix3d c = plane.evidence.covariance(fit_of(points), Vector3d::Zero(), PoseCovariance::Zero());
  Matrix3d expected;
  expected << 4e-6, 0.0, -3e-6,  //
      0.0, 0.0, 0.0,             //
      -3e-6, 0.0, 9e-6;
  EXPECT_TRUE(c.isApprox(expected, 1e-9)) << c;
}

TEST(PoseEvidence, ScansOfUnequalErrorsShareThemInProportion) {
  const double half_s = 10.0 * std::log(2.0);  // then exp(-dt / 10 s) = 1/2
  const auto variance_m2 = [&](const std::vector<double>& sigmas_m) {
    const auto points = patch(0.0, 0.0);
    SeenPlane plane;
    for (std::size_t k = 0; k < sigmas_m.size(); ++k) {
      ScanPose scan = looking_down(0.0, 0.0, 2.0, half_s * static_cast<double>(k));
      scan.covariance = configured_covariance(errors(sigmas_m[k], 0.0, 0.0));
      plane.see(points, scan, errors(0.0, 0.0, 10.0));
    }
    return plane.evidence.covariance(fit_of(points), Vector3d::Zero(), PoseCovariance::Zero())(2, 2);
  };
  EXPECT_NEAR(variance_m2({0.01, 0.02}), 1.75e-4, 1e-9);  // 1/4 (1 + 4 + 2 * 1/2 * 1 * 2) square centimetres
  EXPECT_NEAR(variance_m2({0.01, 0.02, 0.03}), 23.5e-4 / 9.0, 1e-9);  // 1/9 (14 + 2 (1/2 * 2 + 1/2 * 6 + 1/4 * 3))
  EXPECT_NEAR(variance_m2({0.01, 0.0}), 0.25e-4, 1e-9);               // an exact one beside it halves the error
}

TEST(PoseEvidence, HalvesThatWereSeenTogetherAreNoSurerThanTheWhole) {
  const PoseErrorConfig config = errors(0.01, 0.0, 10.0);
  const Vector3d other_origin_m(2.0, 0.5, 0.0);
  SeenPlane left;
  SeenPlane right{other_origin_m};
  for (int k = 0; k < 5; ++k) {
    const ScanPose scan = looking_down(1.0, 0.0, 2.0, k);
    left.see(patch(0.0, 0.0), scan, config);
    right.see(patch(2.0, 0.0), scan, config);
  }
  auto all = patch(0.0, 0.0);
  const auto more = patch(2.0, 0.0);
  const PoseCovariance x = configured_covariance(config);
  const double of_one_half = left.evidence.covariance(fit_of(all), Vector3d::Zero(), x)(2, 2);
  all.insert(all.end(), more.begin(), more.end());
  left.evidence.add(right.evidence, other_origin_m, config);
  const double of_both = left.evidence.covariance(fit_of(all), Vector3d::Zero(), x)(2, 2);
  EXPECT_NEAR(of_both, of_one_half, 0.05 * of_one_half);
}

TEST(PoseEvidence, WhatLeavesTakesTheErrorOfTheScanThatItLeavesIn) {
  // Two shares come with one scan's error x_1, one of them goes with the next one's: 2 x_1 - x_2 remains.
  const auto variance_m2 = [](double correlation_s) {
    const PoseErrorConfig config = errors(0.01, 0.0, correlation_s);
    const auto points = patch(0.0, 0.0);
    SeenPlane plane;
    plane.see(points, looking_down(0.0, 0.0, 2.0, 0.0), config, 2.0);
    plane.see(points, looking_down(0.0, 0.0, 2.0, 1.0), config, -1.0);
    return plane.evidence.covariance(fit_of(points), Vector3d::Zero(), PoseCovariance::Zero())(2, 2);
  };
  EXPECT_NEAR(variance_m2(0.0), 5e-4, 1e-9);                  // 4 + 1: each pose errs on its own
  EXPECT_NEAR(variance_m2(1.0 / std::log(2.0)), 3e-4, 1e-9);  // 4 + 1 - 2 * 2 * 1/2
  EXPECT_NEAR(variance_m2(1e9), 1e-4, 1e-9);                  // one and the same error
}

TEST(PoseEvidence, NothingChangesWhereNothingOfThePlaneIsSeen) {
  const PoseErrorConfig config = errors(0.01, 0.02, 1.0);
  const auto points = patch(0.0, 0.0);
  SeenPlane plane;
  plane.see(points, looking_down(0.5, 0.0, 2.0, 0.0), config);
  const Matrix3d before = plane.evidence.covariance(fit_of(points), Vector3d::Zero(), PoseCovariance::Zero());
  plane.see({}, looking_down(-0.5, 0.0, 3.0, 5.0), config);
  EXPECT_TRUE(plane.evidence.covariance(fit_of(points), Vector3d::Zero(), PoseCovariance::Zero()).isApprox(before));
}

TEST(PoseEvidence, WithoutEvidenceAPlaneIsAsWrongAsOneScan) {
  const PoseCovariance x = configured_covariance(errors(0.01, 0.02, 1.0));
  const Matrix3d c = PoseEvidence().covariance(fit_of(patch(0.0, 0.0)), Vector3d::Zero(), x);
  EXPECT_TRUE(c.isApprox(Vector3d(4e-4, 4e-4, 1e-4).asDiagonal().toDenseMatrix(), 1e-12));
}

}  // namespace
}  // namespace planemap

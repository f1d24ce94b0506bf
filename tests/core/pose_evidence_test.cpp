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
  PoseEvidence evidence;
  for (const double time_s : times_s) {
    evidence.add(moments_of(points, Vector3d::Zero()), Vector3d::UnitZ(), Vector3d::Zero(),
                 looking_down(0.0, 0.0, 2.0, time_s), config);
  }
  return evidence.covariance(fit_of(points), Vector3d::Zero(), config);
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

TEST(PoseEvidence, IsTheScatterOfFitsWithWanderingPoses) {
  // A walk along a strip, its poses disturbed as a whole, point by point; the plane fitted to all of the points.
  constexpr int kScans = 40;
  constexpr int kTrials = 600;
  constexpr double kStepS = 0.5;
  const PoseErrorConfig config = errors(0.004, 0.002, 3.0);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const Vector3d origin_m(0.7, -0.4, 0.0);
  PoseEvidence evidence;
  std::vector<ScanPose> scans;
  std::vector<std::vector<Vector3d>> seen;
  std::vector<Vector3d> all;
  for (int k = 0; k < kScans; ++k) {
    const double x_m = 0.08 * k;
    scans.push_back(looking_down(x_m - 1.0, 0.3, 2.0 + 0.01 * k, kStepS * k));
    seen.push_back(patch(x_m, 0.0));
    all.insert(all.end(), seen.back().begin(), seen.back().end());
    evidence.add(moments_of(seen.back(), origin_m), Vector3d::UnitZ(), origin_m, scans.back(), config);
  }
  const PlaneFit fit = fit_of(all);
  const Matrix3d stated = evidence.covariance(fit, origin_m, config);

  Matrix3d equations = Matrix3d::Zero();
  const auto row = [&](const Vector3d& p) {
    return Vector3d(p.y() - fit.centroid_m.y(), p.x() - fit.centroid_m.x(), 1.0);
  };
  for (const Vector3d& p : all) equations += row(p) * row(p).transpose();
  Matrix3d scatter = Matrix3d::Zero();
  const double kept = std::exp(-kStepS / config.correlation_s);
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::Matrix<double, 6, 1> state;
    for (double& value : state) value = normal(random);
    Vector3d heights = Vector3d::Zero();
    for (std::size_t k = 0; k < scans.size(); ++k) {
      const Isometry3d& T = scans[k].T_world_sensor;
      const Vector3d rotation = config.sigma_rad * state.tail<3>();
      Isometry3d error = Isometry3d::Identity();
      error.translation() = config.sigma_m * state.head<3>();
      error.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
      const Isometry3d disturbed = T * error * T.inverse();
      for (const Vector3d& p : seen[k]) heights += row(p) * (disturbed * p).z();
      for (double& value : state) value = kept * value + std::sqrt(1.0 - kept * kept) * normal(random);
    }
    const Vector3d estimate = equations.inverse() * heights;
    scatter += estimate * estimate.transpose() / kTrials;
  }
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(std::sqrt(stated(i, i) / scatter(i, i)), 1.0, 0.1) << i;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    EXPECT_NEAR(stated(i, j) / std::sqrt(stated(i, i) * stated(j, j)),
                scatter(i, j) / std::sqrt(scatter(i, i) * scatter(j, j)), 0.12)
        << i << j;
  }
}

TEST(PoseEvidence, HalvesThatWereSeenTogetherAreNoSurerThanTheWhole) {
  const PoseErrorConfig config = errors(0.01, 0.0, 10.0);
  const Vector3d other_origin_m(2.0, 0.5, 0.0);
  PoseEvidence left;
  PoseEvidence right;
  for (int k = 0; k < 5; ++k) {
    const ScanPose scan = looking_down(1.0, 0.0, 2.0, k);
    left.add(moments_of(patch(0.0, 0.0), Vector3d::Zero()), Vector3d::UnitZ(), Vector3d::Zero(), scan, config);
    right.add(moments_of(patch(2.0, 0.0), other_origin_m), Vector3d::UnitZ(), other_origin_m, scan, config);
  }
  auto all = patch(0.0, 0.0);
  const auto more = patch(2.0, 0.0);
  const double of_one_half = left.covariance(fit_of(all), Vector3d::Zero(), config)(2, 2);
  all.insert(all.end(), more.begin(), more.end());
  left.add(right, other_origin_m, config);
  const double of_both = left.covariance(fit_of(all), Vector3d::Zero(), config)(2, 2);
  EXPECT_NEAR(of_both, of_one_half, 0.05 * of_one_half);
}

TEST(PoseEvidence, WithoutEvidenceAPlaneIsAsWrongAsOneScan) {
  const PoseErrorConfig config = errors(0.01, 0.02, 1.0);
  const Matrix3d c = PoseEvidence().covariance(fit_of(patch(0.0, 0.0)), Vector3d::Zero(), config);
  EXPECT_TRUE(c.isApprox(Vector3d(4e-4, 4e-4, 1e-4).asDiagonal().toDenseMatrix(), 1e-12));
}

}  // namespace
}  // namespace planemap

#include "planemap/plane_statistics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <random>

namespace planemap {
namespace {

using Eigen::Vector3d;

/// A cell of points about its centre.
Cell cell_of(const std::vector<Vector3d>& points_m, const Vector3d& centre_m, double sigma_m) {
  ScanSums scan;
  for (const Vector3d& p : points_m) {
    scan.points.add(Moments{1.0, p - centre_m, Symmetric3::outer(p - centre_m)});
    scan.error_m2 += Vector3d::Constant(sigma_m * sigma_m);
    scan.view += Eigen::Vector3f(0.0F, 0.0F, 1.0F);
  }
  Cell cell;
  cell.add(scan, Vector3d::UnitZ());
  cell.normal = Eigen::Vector3f::UnitZ();
  cell.deviation_rad = 0.02F;
  cell.plane_weight = 1.0F;
  return cell;
}

TEST(PlaneStatistics, PooledFitOfFourPointsByHand) {
  // The corners of a 2 x 4 rectangle at z = 1: spreads 1 and 4, centroid (1, 2, 1).
  PlaneStatistics statistics(Vector3d::Zero());
  statistics.add(cell_of({{0, 0, 1}, {2, 0, 1}, {0, 4, 1}, {2, 4, 1}}, {1, 2, 1}, 0.1), {1, 2, 1});
  const auto fit = statistics.fit(/*pooled=*/true);
  ASSERT_TRUE(fit.has_value());
  EXPECT_TRUE(fit->plane.normal().isApprox(Vector3d::UnitZ(), 1e-9));
  EXPECT_NEAR(fit->plane.d(), -1.0, 1e-9);
  EXPECT_TRUE(fit->centroid_m.isApprox(Vector3d(1, 2, 1), 1e-9));
  EXPECT_NEAR(fit->spread_1_m2, 1.0, 1e-6);
  EXPECT_NEAR(fit->spread_2_m2, 4.0, 1e-6);
  EXPECT_NEAR(fit->residual_m2, 0.0, 1e-9);
  EXPECT_NEAR(fit->extent_m(), std::sqrt(48.0), 1e-6);
}

TEST(Cell, EvidenceCountsByTheErrorsOfItsScan) {
  // A point at 0 mm with sigma 1 mm along z, one at 10 mm with 3 mm: weights 9 to 1, so the mean is 1 mm; the harmonic
  // mean of the variances is 2 / (1 + 1/9) mm2. Errors across the normal don't count.
  Cell cell;
  ScanSums near;
  near.points = {1.0, Vector3d::Zero(), {}};
  near.error_m2 = {4e-6, 9e-6, 1e-6};
  ScanSums far;
  far.points = {1.0, Vector3d(0, 0, 0.01), Symmetric3::outer(Vector3d(0, 0, 0.01))};
  far.error_m2 = {1e-6, 1e-6, 9e-6};
  cell.add(near, Vector3d::UnitZ());
  cell.add(far, Vector3d::UnitZ());
  EXPECT_NEAR(cell.evidence.unpacked().mean().z(), 0.001, 1e-9);
  EXPECT_NEAR(cell.evidence_variance_m2(), 1.8e-6, 1e-12);
  EXPECT_NEAR(cell.sums.mean_m().z(), 0.005, 1e-12);  // the virtual centre counts every point as one
}

TEST(PlaneStatistics, WithoutPoolingThePlaneIsTheMeanOfTheNormalsThroughTheMeanCentre) {
  PlaneStatistics statistics(Vector3d::Zero());
  Cell a = cell_of({{0, 0, 1}}, {0, 0, 1}, 0.1);
  Cell b = cell_of({{1, 0, 1}}, {1, 0, 1}, 0.1);
  a.normal = Vector3d(0.1, 0, 1).normalized().cast<float>();
  b.normal = Vector3d(-0.1, 0, 1).normalized().cast<float>();
  statistics.add(a, {0, 0, 1});
  statistics.add(b, {1, 0, 1});
  const auto fit = statistics.fit(/*pooled=*/false);
  ASSERT_TRUE(fit.has_value());
  EXPECT_TRUE(fit->plane.normal().isApprox(Vector3d::UnitZ(), 1e-6));
  EXPECT_TRUE(fit->centroid_m.isApprox(Vector3d(0.5, 0, 1), 1e-9));
  EXPECT_NEAR(fit->deviation_rad, std::sqrt(2.0 * 0.02 * 0.02) / 2.0, 1e-7);  // sqrt(S_s) / n
}

TEST(PlaneStatistics, CellsThatLeaveLeaveNothing) {
  PlaneStatistics statistics({3.0, -1.0, 0.5});
  const Cell stays = cell_of({{0, 0, 1}, {2, 0, 1}, {0, 4, 1}}, {1, 2, 1}, 0.1);
  const Cell leaves = cell_of({{5, 5, 2}, {6, 5, 3}}, {5, 5, 2}, 0.3);
  statistics.add(stays, {1, 2, 1});
  const auto before = statistics.fit(true);
  statistics.add(leaves, {5, 5, 2});
  statistics.remove(leaves, {5, 5, 2});
  const auto after = statistics.fit(true);
  ASSERT_TRUE(before && after);
  EXPECT_TRUE(after->plane.normal().isApprox(before->plane.normal(), 1e-9));
  EXPECT_NEAR(after->plane.d(), before->plane.d(), 1e-9);
  EXPECT_EQ(statistics.cell_count(), 1U);
  EXPECT_DOUBLE_EQ(statistics.point_count(), 3.0);
}

TEST(PlaneStatistics, TwoSetsTogetherAreTheSetOfAllCells) {
  const Cell a = cell_of({{0, 0, 1}, {2, 0, 1.1}, {0, 4, 1}}, {1, 2, 1}, 0.1);
  const Cell b = cell_of({{5, 5, 1.3}, {6, 5, 1.2}}, {5, 5, 1}, 0.3);
  PlaneStatistics all(Vector3d::Zero());
  all.add(a, {1, 2, 1});
  all.add(b, {5, 5, 1});
  PlaneStatistics first({1, 2, 1});
  first.add(a, {1, 2, 1});
  PlaneStatistics second({5, 5, 1});
  second.add(b, {5, 5, 1});
  first.add(second);
  const auto expected = all.fit(true);
  const auto fit = first.fit(true);
  ASSERT_TRUE(expected && fit);
  EXPECT_TRUE(fit->plane.normal().isApprox(expected->plane.normal(), 1e-9));
  EXPECT_NEAR(fit->plane.d(), expected->plane.d(), 1e-9);
  EXPECT_GT(expected->cell_dispersion, 0.0);
  EXPECT_NEAR(fit->cell_dispersion, expected->cell_dispersion, 1e-6 * expected->cell_dispersion);
}

/// Cells of two points each at the corners of a square of 2 m, their means 3 mm above and below it by turns: they say
/// nothing of a tilt, so the plane passes between them. The points lie 10 mm above and below their means.
std::vector<std::pair<Cell, Vector3d>> twisted_square(double sigma_m) {
  std::vector<std::pair<Cell, Vector3d>> cells;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const double z = 0.003 * x * y;
      const Vector3d centre(x, y, 0.02);
      cells.emplace_back(cell_of({{x, y, z - 0.01}, {x, y, z + 0.01}}, centre, sigma_m), centre);
    }
  }
  return cells;
}

TEST(PlaneStatistics, CellsDisperseAsTheirMeansDoInUnitsOfTheirErrors) {
  PlaneStatistics statistics({5.0, -3.0, 0.1});
  for (const auto& [cell, centre] : twisted_square(0.002)) statistics.add(cell, centre);
  const auto fit = statistics.fit(true);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(std::abs(fit->plane.normal().z()), 1.0, 1e-9);
  // Each mean of two points errs by 2 mm / sqrt(2), so 4 x (3 mm)^2 / (2 mm^2), for 4 - 3 degrees of freedom.
  EXPECT_NEAR(fit->cell_dispersion, 18.0, 1e-4);
  EXPECT_DOUBLE_EQ(statistics.fit(false)->cell_dispersion, 0.0) << "the mean of the normals has an error of its own";
}

TEST(PlaneStatistics, OnlyCellsThatShapeThePlaneSayHowTheyDisperse) {
  PlaneStatistics statistics(Vector3d::Zero());
  for (const auto& [cell, centre] : twisted_square(0.002)) statistics.add(cell, centre);
  Cell at_edge = cell_of({{3, 0, 0.1}, {3, 0, 0.2}}, {3, 0, 0.1}, 0.002);
  at_edge.plane_weight = 0.0F;
  statistics.add(at_edge, {3, 0, 0.1});
  EXPECT_NEAR(statistics.fit(true)->cell_dispersion, 18.0, 1e-4);
  Cell comes_and_goes = cell_of({{0, 3, 0.1}, {0, 3, 0.2}}, {0, 3, 0.1}, 0.002);
  statistics.add(comes_and_goes, {0, 3, 0.1});
  EXPECT_GT(statistics.fit(true)->cell_dispersion, 100.0);
  statistics.remove(comes_and_goes, {0, 3, 0.1});
  EXPECT_NEAR(statistics.fit(true)->cell_dispersion, 18.0, 1e-4);
}

TEST(PlaneStatistics, PointsOnALineSpanNoPlane) {
  PlaneStatistics statistics(Vector3d::Zero());
  statistics.add(cell_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {1, 0, 0}, 0.1), {1, 0, 0});
  EXPECT_FALSE(statistics.fit(true).has_value());
  EXPECT_FALSE(PlaneStatistics(Vector3d::Zero()).fit(true).has_value());
}

TEST(Covariance, IsTheScatterOfRepeatedFits) {
  // 400 fits to a noisy patch far from the origin: their scatter is what the covariance says.
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  constexpr double kSigma = 0.01;
  const Vector3d centre(3.0, 2.0, 1.0);
  std::vector<Eigen::Vector4d> errors;
  Eigen::Matrix4d stated = Eigen::Matrix4d::Zero();
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<Vector3d> points;
    for (int i = 0; i < 200; ++i) {
      points.emplace_back(centre.x() + 2.0 * place(random), centre.y() + place(random),
                          centre.z() + kSigma * normal(random));
    }
    PlaneStatistics statistics(Vector3d::Zero());
    statistics.add(cell_of(points, centre, kSigma), centre);
    const auto fit = statistics.fit(true);
    ASSERT_TRUE(fit.has_value());
    stated = covariance_of(*fit, sensor_covariance(*fit, 0.0));
    Eigen::Vector4d error;
    error << fit->plane.normal() - Vector3d::UnitZ(), fit->plane.d() + 1.0;
    errors.push_back(error);
  }
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (const Eigen::Vector4d& e : errors) scatter += e * e.transpose() / 400.0;
  for (const int i : {0, 1, 3}) EXPECT_NEAR(std::sqrt(stated(i, i) / scatter(i, i)), 1.0, 0.15) << i;
  EXPECT_NEAR(stated(0, 3) / std::sqrt(stated(0, 0) * stated(3, 3)),
              scatter(0, 3) / std::sqrt(scatter(0, 0) * scatter(3, 3)), 0.15);
}

TEST(Covariance, GrowsByWhatCellsDisperseBeyondTheirPointsErrors) {
  PlaneFit fit;
  fit.spread_1_m2 = 1.0;
  fit.spread_2_m2 = 4.0;
  fit.weight = 1e6;
  fit.tilt_1_rad2 = 1e-6;
  fit.tilt_2_rad2 = 0.25e-6;
  const Vector3d of_points(1e-6, 0.25e-6, 1e-6);
  const auto diagonal = [&](double dispersion) -> Vector3d {
    fit.cell_dispersion = dispersion;
    return sensor_covariance(fit, 0.0).diagonal();
  };
  EXPECT_TRUE(diagonal(0.0).isApprox(of_points));         // not measured
  EXPECT_TRUE(diagonal(0.2).isApprox(of_points));         // no less than the points' errors make
  EXPECT_TRUE(diagonal(3.0).isApprox(12.0 * of_points));  // by patches of two cells by two
}

TEST(Covariance, HasRankThreeAndItsFloor) {
  PlaneFit fit;
  fit.centroid_m = {1.0, 2.0, 0.0};
  fit.plane = Plane::through(fit.centroid_m, Vector3d::UnitZ());
  fit.spread_1_m2 = 1.0 / 3.0;  // half extents of 1 m and 2 m
  fit.spread_2_m2 = 4.0 / 3.0;
  fit.weight = 1e18;  // and with it exact tilts
  const Eigen::Matrix4d c = covariance_of(fit, sensor_covariance(fit, /*offset_floor_m=*/1e-3));
  EXPECT_NEAR(std::sqrt(c(0, 0)), 1e-3, 1e-6);                   // 1 mm over 1 m
  EXPECT_NEAR(std::sqrt(c(1, 1)), 0.5e-3, 1e-6);                 // 1 mm over 2 m
  EXPECT_NEAR(c(2, 2), 0.0, 1e-15);                              // |n| = 1
  EXPECT_NEAR(std::sqrt(c(3, 3)), std::sqrt(3.0) * 1e-3, 1e-6);  // 1 mm, 1 m x 1 mrad, 2 m x 0.5 mrad
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(c);
  EXPECT_NEAR(solver.eigenvalues()(0), 0.0, 1e-12);
  EXPECT_GT(solver.eigenvalues()(1), 1e-9);
}

TEST(SquaredChord, OfSixtyDegreesIsOne) {
  EXPECT_NEAR(squared_chord(std::numbers::pi / 3.0), 1.0, 1e-12);
}

TEST(ExpectedDistanceOfNormals, AddsBothVariances) {
  EXPECT_NEAR(expected_squared_distance(Vector3d::UnitZ(), 0.1, Vector3d::UnitX(), 0.2), 2.0 + 0.01 + 0.04, 1e-12);
}

}  // namespace
}  // namespace planemap

#include "planemap/moments.hpp"

#include <gtest/gtest.h>

#include <random>

namespace planemap {
namespace {

using Eigen::Vector3d;

Moments moments_of(const std::vector<Vector3d>& points, const Vector3d& reference) {
  Moments m;
  for (const Vector3d& p : points) m.add(Moments{1.0, p - reference, Symmetric3::outer(p - reference)});
  return m;
}

std::vector<Vector3d> random_points(std::size_t count) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(1.0 + normal(random), normal(random) - 2.0, 0.1 * normal(random));
  return points;
}

TEST(Symmetric3, QuadraticIsTheMatrixBetweenTwoVectors) {
  const Symmetric3 s{{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}};
  // (1 2 -1) M (1 2 -1)^T by hand: 1*1 + 4*4 + 6*1 + 2*(2*1*2 + 3*1*-1 + 5*2*-1) = 23 + 2 * (-9) = 5.
  EXPECT_DOUBLE_EQ(s.quadratic({1.0, 2.0, -1.0}), 5.0);
  EXPECT_DOUBLE_EQ(Vector3d(1, 2, -1).dot(s.matrix() * Vector3d(1, 2, -1)), 5.0);
}

TEST(Moments, MeanAndCovarianceOfTwoPointsByHand) {
  const Moments m = moments_of({{0.0, 0.0, 0.0}, {2.0, 0.0, 4.0}}, Vector3d::Zero());
  EXPECT_TRUE(m.mean().isApprox(Vector3d(1.0, 0.0, 2.0)));
  Eigen::Matrix3d expected;
  expected << 1, 0, 2, 0, 0, 0, 2, 0, 4;
  EXPECT_TRUE(m.covariance().isApprox(expected));
}

TEST(Moments, AddedAboutAnotherPointEqualThoseOfAllPoints) {
  const std::vector<Vector3d> points = random_points(50);
  const Vector3d r1(0.5, 0.5, 0.5);
  const Vector3d r2(-3.0, 1.0, 2.0);
  Moments shifted;
  shifted.add(moments_of(points, r2), 1.0, r2 - r1);
  const Moments direct = moments_of(points, r1);
  EXPECT_NEAR(shifted.weight, direct.weight, 1e-12);
  EXPECT_TRUE(shifted.first.isApprox(direct.first, 1e-12));
  EXPECT_TRUE(shifted.second.matrix().isApprox(direct.second.matrix(), 1e-12));
}

TEST(Moments, TakenAwayAgainLeaveNothing) {
  const Moments part = moments_of(random_points(20), {4.0, 0.0, 0.0});
  Moments sum = moments_of(random_points(30), Vector3d::Zero());
  const Moments before = sum;
  sum.add(part, 2.5, {1.0, 2.0, 3.0});
  sum.add(part, -2.5, {1.0, 2.0, 3.0});
  EXPECT_NEAR(sum.weight, before.weight, 1e-12);
  EXPECT_TRUE(sum.second.matrix().isApprox(before.second.matrix(), 1e-12));
}

TEST(Moments, MeanSquareDistanceIsThatOfThePoints) {
  const std::vector<Vector3d> points = random_points(40);
  const Vector3d normal = Vector3d(1.0, -2.0, 0.5).normalized();
  double sum = 0.0;
  for (const Vector3d& p : points) sum += (normal.dot(p) + 0.3) * (normal.dot(p) + 0.3);
  EXPECT_NEAR(moments_of(points, Vector3d::Zero()).mean_square_distance(normal, 0.3), sum / 40.0, 1e-12);
}

}  // namespace
}  // namespace planemap

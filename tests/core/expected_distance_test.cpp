#include "planemap/expected_distance.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace planemap {
namespace {

using Eigen::Vector3d;

/// Points (0,0,0) and (2,4,6) with standard errors 0.1 and 0.3 along every axis: n = 2, L = (2,4,6),
/// S_s = 0.01 + 0.09 = 0.1 along every axis.
CentreStatistics two_points() {
  return {2.0, {2.0, 4.0, 6.0}, Vector3d::Constant(0.1)};
}

TEST(ExpectedDistance, Eq1CentreIsTheMeanOfThePoints) {
  EXPECT_EQ(expected_centre(two_points()), Vector3d(1, 2, 3));
}

TEST(ExpectedDistance, Eq3AddsTheSquareSumOfTheErrorsOverNSquared) {
  // L^2/n^2 = 1 + 4 + 9 = 14; S_s/n^2 = 3 * 0.1 / 4 = 0.075.
  EXPECT_NEAR(expected_squared_norm(two_points()), 14.075, 1e-12);
}

TEST(ExpectedDistance, Eq5AddsThePointsOwnError) {
  EXPECT_NEAR(expected_squared_norm(Vector3d(1, 0, 2), Vector3d(0.01, 0.04, 0.09)), 5.14, 1e-12);
}

TEST(ExpectedDistance, Eq7ByHand) {
  // p = (1,2,5), eps^2 = (0.01, 0.02, 0.03): |p - L/n|^2 = 4; 0.06 of the point; 0.075 of the centre.
  EXPECT_NEAR(expected_squared_distance({1, 2, 5}, {0.01, 0.02, 0.03}, two_points()), 4.135, 1e-12);
}

TEST(ExpectedDistance, Eq7EqualsThePapersExpandedForm) {
  const Vector3d p(0.3, -1.2, 0.7);
  const Vector3d variance(0.01, 0.02, 0.03);
  const CentreStatistics u = two_points();
  // p_j^2 + eps(p_j)^2 + L^2/n^2 + S_s/n^2 - 2 p_j L/n, as printed; the mixed term is Eq. 6.
  const double printed = p.squaredNorm() + variance.sum() + u.linear.squaredNorm() / 4.0 + u.error.sum() / 4.0 -
                         2.0 * p.dot(u.linear / 2.0);
  EXPECT_NEAR(expected_squared_distance(p, variance, u), printed, 1e-12);
}

TEST(ExpectedDistance, Eq4IsTheMeanOverTheErrors) {
  // Monte Carlo over what is random in Eq. 4: the point's error and the errors of the cell's points.
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const auto error = [&](double sigma) -> Vector3d {
    return Vector3d(normal(random), normal(random), normal(random)) * sigma;
  };
  const Vector3d p(1, 2, 5);
  double sum = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const Vector3d centre = (error(0.1) + Vector3d(2, 4, 6) + error(0.3)) / 2.0;
    sum += (p + error(0.2) - centre).squaredNorm();
  }
  EXPECT_NEAR(sum / kDraws, expected_squared_distance(p, Vector3d::Constant(0.04), two_points()), 0.01);
}

TEST(ExpectedDistance, KeepsItsDigitsFarFromTheOrigin) {
  // A kilometre away the expanded form in float loses all of the 1 cm; this one does not.
  const Vector3d far(1000.0, 1000.0, 1000.0);
  const CentreStatistics u{3.0, 3.0 * far, Vector3d::Zero()};
  EXPECT_NEAR(expected_squared_distance(far + Vector3d(0.01, 0, 0), Vector3d::Zero(), u), 1e-4, 1e-12);
}

}  // namespace
}  // namespace planemap

#include "planemap/plane.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace planemap {
namespace {

TEST(Plane, CoefficientsAreScaledTogether) {
  const auto plane = Plane::from_coefficients({0.0, 0.0, 2.0}, -3.0);
  ASSERT_TRUE(plane.has_value());
  EXPECT_EQ(plane->normal(), Eigen::Vector3d::UnitZ());
  EXPECT_DOUBLE_EQ(plane->d(), -1.5);
  EXPECT_DOUBLE_EQ(plane->signed_distance_m({7.0, 8.0, 2.0}), 0.5);
}

TEST(Plane, ZeroNormalIsRefused) {
  const auto plane = Plane::from_coefficients(Eigen::Vector3d::Zero(), 1.0);
  ASSERT_FALSE(plane.has_value());
  EXPECT_EQ(plane.error().message, "plane: the normal must not be zero");
}

TEST(Plane, NumbersThatAreNotFiniteAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Plane::from_coefficients({nan, 0.0, 1.0}, 0.0).has_value());
  EXPECT_FALSE(Plane::from_coefficients({0.0, 0.0, 1.0}, nan).has_value());
}

TEST(Plane, GoesThroughItsPoint) {
  EXPECT_NEAR(Plane::through({1.0, 2.0, 3.0}, Eigen::Vector3d::UnitY()).signed_distance_m({5.0, 2.0, -1.0}), 0.0,
              1e-15);
}

}  // namespace
}  // namespace planemap

#include "planemap/membership.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace planemap {
namespace {

using Eigen::Vector3d;

constexpr double kCell_m = 0.08;

TEST(ExpectedScatter, IsAllOfTheNoiseWhereItFitsIntoACell) {
  EXPECT_DOUBLE_EQ(expected_scatter_m2(0.03, kCell_m, 25e-6), 25e-6);  // 5 mm
}

TEST(ExpectedScatter, OfALayerIsThatOfTheTailThatItHolds) {
  // Noise of 40 mm about a plane; cells whose centres lie 0, 80 and -80 mm off it hold what falls into their 80 mm.
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.04);
  double sums[3] = {};
  int counts[3] = {};
  for (int i = 0; i < 400000; ++i) {
    const double x = normal(random);
    for (int layer = 0; layer < 3; ++layer) {
      const double centre = layer == 0 ? 0.0 : layer == 1 ? kCell_m : -kCell_m;
      if (std::abs(x - centre) >= 0.5 * kCell_m) continue;
      sums[layer] += x * x;
      ++counts[layer];
    }
  }
  EXPECT_NEAR(expected_scatter_m2(0.0, kCell_m, 1.6e-3) / (sums[0] / counts[0]), 1.0, 0.01);
  EXPECT_NEAR(expected_scatter_m2(kCell_m, kCell_m, 1.6e-3) / (sums[1] / counts[1]), 1.0, 0.01);
  EXPECT_NEAR(expected_scatter_m2(-kCell_m, kCell_m, 1.6e-3) / (sums[2] / counts[2]), 1.0, 0.01);
}

/// A cell about the origin that holds a patch through its centre, `offset_m` off it along the normal, with noise.
Cell cell_with(const Vector3d& normal, double offset_m, double sigma_m, const Vector3d& second_normal = {0, 0, 0}) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> place(-0.5 * kCell_m, 0.5 * kCell_m);
  std::normal_distribution<double> noise(0.0, sigma_m);
  ScanSums scan;
  for (int i = 0; i < 2000; ++i) {
    const bool second = second_normal.norm() > 0.5 && i % 2 == 0;
    const Vector3d n = second ? second_normal : normal;
    Vector3d p(place(random), place(random), place(random));
    p += (offset_m + noise(random) - n.dot(p)) * n;
    scan.points.add(Moments{1.0, p, Symmetric3::outer(p)});
    scan.error_m2 += Vector3d::Constant(sigma_m * sigma_m);
  }
  Cell cell;
  cell.add(scan, normal);
  return cell;
}

bool is_other(const Cell& cell, const Vector3d& normal, double distance_m) {
  return is_other_surface(cell, Vector3d::Zero(), Plane::through(-distance_m * normal, normal), kCell_m);
}

TEST(OtherSurface, ACellOfThePlaneIsNot) {
  EXPECT_FALSE(is_other(cell_with(Vector3d::UnitZ(), 0.0, 0.004), Vector3d::UnitZ(), 0.0));
}

TEST(OtherSurface, IsOneThatTurnsAwayByTwelveDegreesButNotByFour) {
  const auto turned = [](double degrees) {
    return Vector3d(std::sin(degrees * M_PI / 180.0), 0.0, std::cos(degrees * M_PI / 180.0));
  };
  EXPECT_TRUE(is_other(cell_with(turned(12.0), 0.0, 0.004), Vector3d::UnitZ(), 0.0));
  EXPECT_FALSE(is_other(cell_with(turned(4.0), 0.0, 0.004), Vector3d::UnitZ(), 0.0));
}

TEST(OtherSurface, IsOneThatLiesThreeCentimetresOffButNotOneCentimetre) {
  EXPECT_TRUE(is_other(cell_with(Vector3d::UnitZ(), 0.0, 0.004), Vector3d::UnitZ(), 0.03));
  EXPECT_FALSE(is_other(cell_with(Vector3d::UnitZ(), 0.0, 0.004), Vector3d::UnitZ(), 0.01));
}

TEST(OtherSurface, ACellAtAnEdgeIsNotSure) {
  EXPECT_FALSE(is_other(cell_with(Vector3d::UnitX(), 0.0, 0.004, Vector3d::UnitZ()), Vector3d::UnitZ(), 0.0));
}

TEST(OtherSurface, NoiseThatSpreadsOverCellsTellsNothing) {
  EXPECT_FALSE(is_other(cell_with(Vector3d::UnitZ(), 0.0, 0.02), Vector3d::UnitZ(), 0.03));
}

}  // namespace
}  // namespace planemap

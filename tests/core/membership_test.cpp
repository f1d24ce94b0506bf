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

/// A cell about the origin with a level patch through its centre.
Cell level_cell(double sigma_m) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> place(-0.5 * kCell_m, 0.5 * kCell_m);
  std::normal_distribution<double> noise(0.0, sigma_m);
  ScanSums scan;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p(place(random), place(random), noise(random));
    scan.points.add(Moments{1.0, p, Symmetric3::outer(p)});
    scan.error_m2 += Vector3d::Constant(sigma_m * sigma_m);
  }
  Cell cell;
  cell.add(scan, Vector3d::UnitZ());
  return cell;
}

/// Whether a level cell lies aside of a level plane that is so far above it.
bool is_aside(const Cell& cell, double above_m) {
  return lies_aside(cell, Vector3d::Zero(), Plane::through({0.0, 0.0, above_m}, Vector3d::UnitZ()), kCell_m);
}

TEST(LiesAside, FromHalfACentimetreOnAndTheErrorOfTheMean) {
  const Cell cell = level_cell(0.004);  // its mean is known to 0.1 mm
  EXPECT_FALSE(is_aside(cell, 0.0));
  EXPECT_FALSE(is_aside(cell, 0.0045));
  EXPECT_TRUE(is_aside(cell, 0.006));
  EXPECT_TRUE(is_aside(cell, -0.006));
}

TEST(LiesAside, NoiseThatSpreadsOverCellsTellsNothing) {
  EXPECT_FALSE(is_aside(level_cell(0.02), 0.03));
}

}  // namespace
}  // namespace planemap

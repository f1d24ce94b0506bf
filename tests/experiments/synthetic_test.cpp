// The synthetic experiments, by hand-worked numbers.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "synthetic/examples.hpp"
#include "synthetic/tangent_surfaces.hpp"

namespace planemap::experiments {
namespace {

/// A scan of points in units of the cell, all of the same error.
PointScan scan_of(const std::vector<Eigen::Vector3d>& points_cells, double sigma_cells) {
  PointScan scan;
  for (const Eigen::Vector3d& p_cells : points_cells) {
    for (int axis = 0; axis < 3; ++axis) scan.xyz_m.push_back(static_cast<float>(Table::kCellM * p_cells(axis)));
  }
  scan.sigma_m.assign(scan.xyz_m.size(), static_cast<float>(Table::kCellM * sigma_cells));
  return scan;
}

TEST(CentreDistances, TwoPointsBesideTheMiddleOfTheirCell) {
  // The middle is at 0.5: 0.4 and 0.2 away. The virtual centre is at 0.2: 0.1 away from both.
  const PointScan scan = scan_of({{0.1, 0.5, 13.5}, {0.3, 0.5, 13.5}}, 0.0);
  const CentreDistances d = centre_distances({scan}, Eigen::Isometry3d::Identity(), preset(Preset::kPaper));
  EXPECT_NEAR(d.fixed_m / Table::kCellM, 0.3, 1e-5);
  EXPECT_NEAR(d.virtual_m / Table::kCellM, 0.1, 1e-5);
  EXPECT_EQ(d.moved, 0.0);
}

TEST(CentreDistances, APointBesideTheNextCellsCentreGoesThere) {
  // The own cell's centre is (0.1 + 0.9) / 2 = 0.5, the next one's 1.05: the point at 0.9 is 0.15 from that, 0.4 from
  // its own.
  const PointScan scan = scan_of({{0.1, 0.5, 13.5}, {0.9, 0.5, 13.5}, {1.05, 0.5, 13.5}}, 0.0);
  const CentreDistances d = centre_distances({scan}, Eigen::Isometry3d::Identity(), preset(Preset::kPaper));
  EXPECT_NEAR(d.moved, 1.0 / 3.0, 1e-9);
  EXPECT_NEAR(d.virtual_m / Table::kCellM, (0.4 + 0.15 + 0.0) / 3.0, 1e-5);
  EXPECT_NEAR(d.fixed_m / Table::kCellM, (0.4 + 0.4 + 0.45) / 3.0, 1e-5);
}

TEST(TablePoints, LieOnTheThreeSurfacesInProportionToTheirAreas) {
  const auto points = table_points({}, 17600, 0.0, 1);
  int count[3] = {};
  for (const TablePoint& point : points) {
    ++count[point.surface];
    const Eigen::Vector3d p_cells = point.p_m / Table::kCellM;
    if (point.surface == 0) {
      EXPECT_NEAR(p_cells.z(), 0.0, 1e-12);
    }
    if (point.surface == 1) {
      EXPECT_NEAR(p_cells.x(), -5.0, 1e-12);
    }
    if (point.surface == 2) {
      EXPECT_NEAR(p_cells.x(), 5.0, 1e-12);
    }
  }
  // 80, 48 and 48 of 176 cells; five standard deviations of a count are 330.
  EXPECT_NEAR(count[0], 8000, 330);
  EXPECT_NEAR(count[1], 4800, 330);
}

TEST(TablePoints, NoiseIsInUnitsOfTheCell) {
  const auto points = table_points({}, 20000, 0.2, 1);
  double sum = 0.0;
  int count = 0;
  for (const TablePoint& point : points) {
    if (point.surface != 0) continue;
    sum += std::pow(point.p_m.z() / Table::kCellM, 2);
    ++count;
  }
  EXPECT_NEAR(std::sqrt(sum / count), 0.2, 0.008);
}

TEST(NoiseLevels, VirtualCentresAreNearerThanFixedOnesAndBothAreFartherUnderMuchNoise) {
  const NoiseLevel little = measure_noise_level(0.1, along_the_grid());
  const NoiseLevel much = measure_noise_level(0.5, along_the_grid());
  EXPECT_LT(little.distances.virtual_m, little.distances.fixed_m);
  EXPECT_LT(much.distances.virtual_m, much.distances.fixed_m);
  EXPECT_LT(little.distances.fixed_m, much.distances.fixed_m);
  EXPECT_LT(little.distances.virtual_m, much.distances.virtual_m);
}

TEST(AssignmentExample, ExpectedDistancesByHand) {
  const AssignmentExample example = assignment_example();
  ASSERT_EQ(example.rivals.size(), 4U);
  // Cell (0, 0): centre (0.26, 0.3575), |p - C|^2 = 0.58^2 + 0.2025^2, eps^2 = 0.1^2 + 0.07^2, S_s = 0.0126 + 0.0167, n
  // = 4.
  const double by_hand = 0.58 * 0.58 + 0.2025 * 0.2025 + 0.01 + 0.0049 + (0.0126 + 0.0167) / 16.0;
  EXPECT_NEAR(example.rivals[0].expected_cells, std::sqrt(by_hand), 1e-5);
  EXPECT_TRUE(example.rivals[0].holds);
}

TEST(AssignmentExample, ThePointGoesToTheLeastExpectedDistanceWhichIsNotItsOwnCells) {
  const AssignmentExample example = assignment_example();
  for (const Rival& rival : example.rivals) {
    EXPECT_EQ(rival.wins, rival.cell.x() == 1 && rival.cell.y() == 0);
    if (!rival.wins) {
      EXPECT_GT(rival.expected_cells, example.rivals[1].expected_cells);
    }
  }
}

TEST(MinMaxExample, TheClosedFormIsTheTurnOfPlanesFittedToThePerturbedCentres) {
  const MinMaxExample example = min_max_example();
  ASSERT_GT(example.deviation_rad, 0.05);
  EXPECT_NEAR(example.high_tilt_rad - example.tilt_rad, example.deviation_rad, 0.02 * example.deviation_rad);
  EXPECT_NEAR(example.tilt_rad - example.low_tilt_rad, example.deviation_rad, 0.02 * example.deviation_rad);
}

}  // namespace
}  // namespace planemap::experiments

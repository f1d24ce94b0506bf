#include "planemap/cell_normals.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "commit.hpp"
#include "planemap/assignment.hpp"
#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;

/// Axes of total least squares through points: the normal, then the tangents.
Eigen::Matrix3d fitted_axes(const std::vector<Vector3d>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  return solver.eigenvectors();
}
Vector3d fitted_normal(const std::vector<Vector3d>& points) {
  return fitted_axes(points).col(0);
}

/// A 3x3 patch of centres in the plane z = 0, a metre apart, all with the same error along z.
std::vector<UncertainCentre> patch(double sigma_m) {
  std::vector<UncertainCentre> centres;
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) centres.push_back({Vector3d(x, y, 0.0), Vector3d(0.0, 0.0, sigma_m * sigma_m)});
  }
  return centres;
}

TEST(MinMaxDeviation, ByHand) {
  // Along x: sum |t.q| sigma = 6 sigma, sum (t.q)^2 = 6: the slope is sigma.
  EXPECT_NEAR(min_max_deviation_rad(patch(0.02), Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::UnitY()),
              std::atan(0.02), 1e-12);
}

TEST(MinMaxDeviation, IsTheTurnOfAFitToThePerturbedCentres) {
  // Fig. 2a: every centre moves by its error along the normal, to the side that turns the plane about one tangent.
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::uniform_real_distribution<double> sigma(0.005, 0.02);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Vector3d> places;
    Vector3d mean = Vector3d::Zero();
    for (int i = 0; i < 12; ++i) places.emplace_back(2.0 * place(random), place(random), 0.0);
    for (const Vector3d& p : places) mean += p / 12.0;
    std::vector<UncertainCentre> centres;
    for (const Vector3d& p : places) centres.push_back({p - mean, Vector3d(0, 0, std::pow(sigma(random), 2))});
    const Eigen::Matrix3d axes = fitted_axes(places);
    double greatest = 0.0;
    for (const int i : {1, 2}) {
      const Vector3d tangent = axes.col(i);
      std::vector<Vector3d> moved;
      for (const UncertainCentre& c : centres) {
        const double by = std::copysign(std::sqrt(c.variance_m2.z()), tangent.dot(c.offset_m));
        moved.push_back(c.offset_m + Vector3d::UnitZ() * by);
      }
      const Vector3d turned = fitted_normal(moved);
      greatest = std::max(greatest, std::atan(std::abs(turned.dot(tangent) / turned.z())));
    }
    EXPECT_NEAR(min_max_deviation_rad(centres, Vector3d::UnitZ(), axes.col(1), axes.col(2)), greatest, 0.04 * greatest);
  }
}

TEST(MinMaxDeviation, GrowsInProportionToTheError) {
  const double one = min_max_deviation_rad(patch(0.001), Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::UnitY());
  const double two = min_max_deviation_rad(patch(0.002), Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::UnitY());
  EXPECT_NEAR(two / one, 2.0, 1e-4);
}

TEST(MinMaxDeviation, IsInfiniteForALine) {
  const std::vector<UncertainCentre> line = {{Vector3d(-1, 0, 0), Vector3d::Ones()},
                                             {Vector3d(1, 0, 0), Vector3d::Ones()}};
  EXPECT_TRUE(std::isinf(min_max_deviation_rad(line, Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::UnitY())));
}

/// A grid that holds `scans` looks at the walls from a place.
UncertainGrid mapped(const std::vector<testing::Wall>& walls, const Eigen::Isometry3d& T, int scans = 3) {
  UncertainGrid grid(GridConfig{}.cell_size_m);
  Assigner assigner(CoreConfig{}, SensorConfig{}, GridConfig{});
  for (int i = 0; i < scans; ++i) {
    assigner.assign(grid, testing::render(walls, T, static_cast<std::uint64_t>(i)), T);
    testing::commit(grid, assigner.changes());
    assigner.finish(grid);
  }
  return grid;
}

const Vector3d kTilted = Vector3d(-1.0, 0.3, 0.2).normalized();

TEST(NormalEstimator, FindsTheNormalOfAWallTowardsTheSensor) {
  const UncertainGrid grid = mapped({{kTilted, 2.0}}, testing::looking({0, 0, 0}, {1, 0, 0}));
  NormalEstimator estimator(NormalConfig{});
  std::vector<double> errors_deg;
  grid.for_each_cell([&](CellRef ref) {
    if (grid.cell(ref).sums.count < 100.0) return;
    const auto normal = estimator.fit(grid, ref);
    ASSERT_TRUE(normal.has_value());
    EXPECT_GT(normal->normal.dot(kTilted), 0.0);
    errors_deg.push_back(std::acos(std::min(1.0, normal->normal.dot(kTilted))) * 180.0 / M_PI);
  });
  ASSERT_GT(errors_deg.size(), 100U);
  double mean = 0.0;
  for (const double e : errors_deg) mean += e / static_cast<double>(errors_deg.size());
  EXPECT_LT(mean, 1.0);
}

TEST(NormalEstimator, HasNoNormalOnAnEdge) {
  // Two walls at a right angle: a neighbourhood across the edge is not flat.
  const std::vector<testing::Wall> corner = {{-Vector3d::UnitX(), 2.0}, {Vector3d::UnitY(), 0.0}};
  const UncertainGrid grid = mapped(corner, testing::looking({0.5, 1.2, 0}, {2, 0, 0}));
  NormalEstimator estimator(NormalConfig{});
  const auto edge = grid.find(grid.index_of(Vector3d(1.99, 0.01, 0.0)));
  ASSERT_TRUE(edge.has_value());
  EXPECT_FALSE(estimator.fit(grid, *edge).has_value());
  NormalConfig paper;
  paper.flatness_sigmas = 0.0;
  EXPECT_TRUE(NormalEstimator(paper).fit(grid, *edge).has_value());
}

TEST(NormalEstimator, CentresFitIsTotalLeastSquaresOverTheVirtualCentres) {
  const UncertainGrid grid = mapped({{kTilted, 2.0}}, testing::looking({0, 0, 0}, {1, 0, 0}));
  NormalConfig config;
  config.fit = NormalFit::kCentres;
  config.flatness_sigmas = 0.0;
  const auto ref = grid.find(grid.index_of(-2.0 * kTilted));
  ASSERT_TRUE(ref.has_value());
  std::vector<Vector3d> centres;
  grid.for_each_neighbour(*ref, 1, [&](CellRef other) { centres.push_back(grid.virtual_centre_m(other)); });
  ASSERT_GE(centres.size(), 9U);
  const auto normal = NormalEstimator(config).fit(grid, *ref);
  ASSERT_TRUE(normal.has_value());
  EXPECT_NEAR(std::abs(normal->normal.dot(fitted_normal(centres))), 1.0, 1e-9);
}

TEST(NormalEstimator, KeepsTheTwoFacesOfAThinWallApart) {
  // Faces at x = 2 and x = 2.1, each seen from its side only.
  UncertainGrid grid(GridConfig{}.cell_size_m);
  Assigner assigner(CoreConfig{}, SensorConfig{}, GridConfig{});
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Isometry3d T = testing::looking({2.05 + 1.5 * side, 0.02, 0.03}, {2.05, 0.02, 0.03});
    const std::vector<testing::Wall> face = {{Vector3d(side, 0, 0), -side * (2.05 + 0.05 * side)}};
    assigner.assign(grid, testing::render(face, T, 1), T);
    testing::commit(grid, assigner.changes());
    assigner.finish(grid);
  }
  NormalEstimator estimator(NormalConfig{});
  for (const double x : {1.99, 2.11}) {
    const auto ref = grid.find(grid.index_of(Vector3d(x, 0.04, 0.04)));
    ASSERT_TRUE(ref.has_value()) << x;
    const auto normal = estimator.fit(grid, *ref);
    ASSERT_TRUE(normal.has_value()) << x;
    EXPECT_GT(std::abs(normal->normal.x()), std::cos(2.0 * M_PI / 180.0)) << x;
    EXPECT_EQ(std::signbit(normal->normal.x()), x < 2.05) << x;
  }
}

TEST(NormalEstimator, RefreshesOnlyAfterTheCellGrew) {
  UncertainGrid grid = mapped({{kTilted, 2.0}}, testing::looking({0, 0, 0}, {1, 0, 0}));
  NormalEstimator estimator(NormalConfig{});
  const CellRef ref = *grid.find(grid.index_of(-2.0 * kTilted));
  estimator.refresh(grid, ref);
  ASSERT_TRUE(grid.cell(ref).has_normal());
  const Eigen::Vector3f other(1.0F, 0.0F, 0.0F);
  grid.writable(ref).normal = other;
  estimator.refresh(grid, ref);
  EXPECT_EQ(grid.cell(ref).normal, other);
  grid.writable(ref).normal_count *= 0.8F;  // as if a quarter of its points were new
  estimator.refresh(grid, ref);
  EXPECT_NE(grid.cell(ref).normal, other);
}

}  // namespace
}  // namespace planemap

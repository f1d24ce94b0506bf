#include "planemap/outline.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>

namespace planemap {
namespace {

constexpr double kCellM = 0.08;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

using Shape = std::function<bool(double, double)>;

/// Means of the points that a surface leaves in the cells of the world's grid: what virtual centres are for many points
/// of equal error.
/// @param inside  the shape, metres, within 0..width x 0..height
/// @param pose    places the shape's plane (z = 0) in the world
std::vector<Eigen::Vector3d> cells_of(const Shape& inside, double width_m, double height_m,
                                      const Eigen::Isometry3d& pose) {
  struct Sum {
    Eigen::Vector3d points_m = Eigen::Vector3d::Zero();
    int count = 0;
  };
  constexpr double kStepM = 0.008;
  std::map<std::array<int, 3>, Sum> cells;
  for (double x = kStepM / 2; x < width_m; x += kStepM) {
    for (double y = kStepM / 2; y < height_m; y += kStepM) {
      if (!inside(x, y)) continue;
      const Eigen::Vector3d p_m = pose * Eigen::Vector3d(x, y, 0.0);
      const Eigen::Vector3i index = (p_m / kCellM).array().floor().cast<int>();
      Sum& sum = cells[{index.x(), index.y(), index.z()}];
      sum.points_m += p_m;
      ++sum.count;
    }
  }
  std::vector<Eigen::Vector3d> centres_m;
  centres_m.reserve(cells.size());
  for (const auto& entry : cells) centres_m.emplace_back(entry.second.points_m / entry.second.count);
  return centres_m;
}

Outline outline_on(const Eigen::Isometry3d& pose, const std::vector<Eigen::Vector3d>& centres_m) {
  return outline_of(Plane::through(pose.translation(), pose.linear().col(2)), pose.translation(), centres_m, kCellM);
}

Eigen::Isometry3d pose_of(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation_m) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation.toRotationMatrix();
  pose.translation() = translation_m;
  return pose;
}

const Eigen::Isometry3d kAligned = pose_of(Eigen::Quaterniond::Identity(), {0.013, -0.027, 0.031});
const Shape kEverywhere = [](double, double) { return true; };

TEST(BasisOf, IsRightHandedAndDependsOnTheNormalAlone) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d n = Eigen::Vector3d(gauss(random), gauss(random), gauss(random)).normalized();
    const Eigen::Vector3d on_m(gauss(random), gauss(random), gauss(random));
    const Eigen::Vector3d off_m = on_m + 0.3 * n;
    const Plane plane = Plane::through(on_m, n);
    const PlaneBasis basis = basis_of(plane, off_m);
    EXPECT_NEAR((basis.axis_u.cross(basis.axis_v) - n).norm(), 0.0, 1e-12);
    EXPECT_NEAR(basis.axis_u.norm(), 1.0, 1e-12);
    EXPECT_NEAR((basis.origin_m - on_m).norm(), 0.0, 1e-12);
    const PlaneBasis elsewhere = basis_of(Plane::through(on_m + Eigen::Vector3d::Ones(), n), on_m);
    EXPECT_EQ(elsewhere.axis_u, basis.axis_u);
    const Eigen::Vector2d uv_m(0.4, -1.2);
    EXPECT_NEAR((basis.to_plane(basis.to_world(uv_m)) - uv_m).norm(), 0.0, 1e-12);
  }
}

TEST(BasisOf, AWallsAxesAreLevelAndUpright) {
  const PlaneBasis basis = basis_of(Plane::through({0, 0, 0}, Eigen::Vector3d(3, 4, 0) / 5.0), {0, 0, 0});
  EXPECT_NEAR(basis.axis_u.z(), 0.0, 1e-12);
  EXPECT_NEAR(basis.axis_v.z(), 1.0, 1e-12);
}

TEST(OutlineOf, NoCellsGiveNoPolygons) {
  const Outline outline = outline_on(kAligned, {});
  EXPECT_TRUE(outline.polygons.empty());
  EXPECT_EQ(outline.area_m2, 0.0);
}

TEST(OutlineOf, ASingleCellIsASquareAboutItsCentre) {
  const Eigen::Vector3d centre_m(1.0, 2.0, 0.031);
  const Outline outline = outline_on(kAligned, {centre_m});
  ASSERT_EQ(outline.polygons.size(), 1u);
  const Ring& ring = outline.polygons[0].outer;
  ASSERT_EQ(ring.size(), 4u);
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& corner_m : ring) mean_m += outline.basis.to_world(corner_m) / 4.0;
  EXPECT_NEAR((mean_m - centre_m).norm(), 0.0, kCellM / 16);
  // Half a cell wide: all of its sides are borders, each taken back by a quarter.
  EXPECT_NEAR(signed_area_m2(ring), kCellM * kCellM / 4.0, 1e-12);
}

TEST(OutlineOf, ARectangleWithAHoleKeepsBothBorders) {
  const Shape shape = [](double x, double y) { return !(x > 0.6 && x < 1.2 && y > 0.5 && y < 0.9); };
  const Outline outline = outline_on(kAligned, cells_of(shape, 2.0, 1.5, kAligned));
  ASSERT_EQ(outline.polygons.size(), 1u);
  ASSERT_EQ(outline.polygons[0].holes.size(), 1u);
  EXPECT_NEAR(signed_area_m2(outline.polygons[0].outer), 3.0, 0.25 * kCellM * 7.0);
  EXPECT_NEAR(signed_area_m2(outline.polygons[0].holes[0]), -0.24, 0.25 * kCellM * 2.0);
  EXPECT_NEAR(outline.area_m2, 2.76, 0.25 * kCellM * 9.0);
}

TEST(OutlineOf, AnLShapeHasSixCorners) {
  const Shape shape = [](double x, double y) { return x < 0.6 || y < 0.7; };
  const Outline outline = outline_on(kAligned, cells_of(shape, 2.0, 2.0, kAligned));
  ASSERT_EQ(outline.polygons.size(), 1u);
  EXPECT_TRUE(outline.polygons[0].holes.empty());
  EXPECT_EQ(outline.polygons[0].outer.size(), 6u);
  EXPECT_NEAR(outline.area_m2, 4.0 - 1.4 * 1.3, 0.25 * kCellM * 8.0);
}

TEST(OutlineOf, GapsOfLessThanACellVanishAndWiderOnesStay) {
  const auto with_slot = [](double width_m) {
    const Shape shape = [width_m](double x, double) { return std::abs(x - 1.0) > width_m / 2.0; };
    return outline_on(kAligned, cells_of(shape, 2.0, 1.0, kAligned)).polygons.size();
  };
  EXPECT_EQ(with_slot(0.9 * kCellM), 1u);
  EXPECT_EQ(with_slot(3.0 * kCellM), 2u);
}

TEST(OutlineOf, TheLargestPolygonComesFirst) {
  const Shape shape = [](double x, double) { return x < 0.4 || (x > 0.8 && x < 2.0) || x > 2.4; };
  const Outline outline = outline_on(kAligned, cells_of(shape, 3.0, 1.0, kAligned));
  ASSERT_EQ(outline.polygons.size(), 3u);
  double before_m2 = std::numeric_limits<double>::infinity();
  for (const Polygon& polygon : outline.polygons) {
    const double area_m2 = signed_area_m2(polygon.outer);
    EXPECT_LE(area_m2, before_m2);
    EXPECT_GT(area_m2, 0.0);
    before_m2 = area_m2;
  }
}

TEST(OutlineOf, OuterRingsRunCounterClockwiseSeenFromTheNormalsSide) {
  const Eigen::Isometry3d pose =
      pose_of(Eigen::Quaterniond(Eigen::Vector4d(0.3, -0.8, 0.1, 0.5).normalized()), {1.0, -2.0, 0.5});
  const Shape shape = [](double x, double y) { return !(x > 0.6 && x < 1.4 && y > 0.6 && y < 1.4); };
  const Outline outline = outline_on(pose, cells_of(shape, 2.0, 2.0, pose));
  ASSERT_EQ(outline.polygons.size(), 1u);
  ASSERT_EQ(outline.polygons[0].holes.size(), 1u);
  const Eigen::Vector3d normal = pose.linear().col(2);
  const auto turn = [&](const Ring& ring) {  // twice the ring's area as a vector: along the normal if counter-clockwise
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      sum += outline.basis.to_world(ring[i]).cross(outline.basis.to_world(ring[(i + 1) % ring.size()]));
    }
    return sum.dot(normal);
  };
  EXPECT_GT(turn(outline.polygons[0].outer), 0.0);
  EXPECT_LT(turn(outline.polygons[0].holes[0]), 0.0);
}

TEST(OutlineOf, ATurnedRectangleIsNoStaircase) {
  const Eigen::Isometry3d pose =
      pose_of(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())), {0.2, 0.1, 0.03});
  const Outline outline = outline_on(pose, cells_of(kEverywhere, 3.0, 2.0, pose));
  ASSERT_EQ(outline.polygons.size(), 1u);
  double length_m = 0.0;  // a staircase at this angle is 1.36 times as long as its line
  const Ring& ring = outline.polygons[0].outer;
  for (std::size_t i = 0; i < ring.size(); ++i) length_m += (ring[i] - ring[(i + 1) % ring.size()]).norm();
  EXPECT_LT(length_m, 1.1 * 10.0);
}

/// Mean distance by which the outline's border lies outside the true one, cells, over rectangles that are turned by
/// what `rotation` draws.
double mean_overreach_cells(const std::function<Eigen::Quaterniond(double, double, double)>& rotation) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> side_m(0.8, 2.5);
  std::uniform_real_distribution<double> place_m(-2.0, 2.0);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  constexpr int kCount = 24;
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double width_m = side_m(random);
    const double height_m = side_m(random);
    const Eigen::Vector3d place(place_m(random), place_m(random), place_m(random));
    const Eigen::Isometry3d pose = pose_of(rotation(share(random), share(random), share(random)), place);
    const Outline outline = outline_on(pose, cells_of(kEverywhere, width_m, height_m, pose));
    sum += (outline.area_m2 - width_m * height_m) / (2.0 * (width_m + height_m)) / kCellM;
  }
  return sum / kCount;
}

TEST(OutlineOf, AreaIsUnbiased) {
  const auto floor = [](double a, double, double) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(kTwoPi * a, Eigen::Vector3d::UnitZ()));
  };
  const auto wall = [](double a, double, double) {
    return Eigen::AngleAxisd(kTwoPi * a, Eigen::Vector3d::UnitZ()) *
           Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX()));
  };
  const auto any = [](double a, double b, double c) {
    return Eigen::AngleAxisd(kTwoPi * a, Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(kTwoPi * b, Eigen::Vector3d::UnitX()) *
           Eigen::Quaterniond(Eigen::AngleAxisd(kTwoPi * c, Eigen::Vector3d::UnitZ()));
  };
  EXPECT_NEAR(mean_overreach_cells(floor), 0.0, 0.05);
  EXPECT_NEAR(mean_overreach_cells(wall), 0.0, 0.05);
  EXPECT_NEAR(mean_overreach_cells(any), 0.0, 0.05);
}

TEST(OutlineOf, EqualCellsGiveEqualOutlines) {
  const Eigen::Isometry3d pose =
      pose_of(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())), {0.5, 0.5, 0.5});
  std::vector<Eigen::Vector3d> centres_m = cells_of(kEverywhere, 1.5, 1.0, pose);
  const Outline first = outline_on(pose, centres_m);
  std::reverse(centres_m.begin(), centres_m.end());  // whatever their order
  const Outline second = outline_on(pose, centres_m);
  ASSERT_EQ(first.polygons.size(), second.polygons.size());
  EXPECT_EQ(first.polygons[0].outer, second.polygons[0].outer);
}

}  // namespace
}  // namespace planemap

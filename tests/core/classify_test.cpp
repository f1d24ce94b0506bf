#include "planemap/classify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace planemap {
namespace {

Surface surface(const Eigen::Vector3d& normal, double height_m, double area_m2 = 1.0) {
  const Eigen::Vector3d centroid_m(0.0, 0.0, height_m);
  return {Plane::through(centroid_m, normal.normalized()), centroid_m, area_m2};
}

/// A normal so many degrees away from up.
Eigen::Vector3d leaning(double degrees) {
  const double angle_rad = degrees * std::numbers::pi / 180.0;
  return {std::sin(angle_rad), 0.0, std::cos(angle_rad)};
}

const Eigen::Vector3d kUp(0.0, 0.0, 1.0);
const Eigen::Vector3d kDown(0.0, 0.0, -1.0);

TEST(Classify, AllAreOtherWithoutGravity) {
  const std::vector<Surface> surfaces = {surface(kUp, 0.0), surface({1, 0, 0}, 1.0)};
  EXPECT_EQ(classify(surfaces, std::nullopt), (std::vector{PlaneClass::kOther, PlaneClass::kOther}));
}

TEST(Classify, TellsFloorTableCeilingAndWall) {
  const std::vector<Surface> surfaces = {surface(kUp, 0.75), surface(kUp, 0.0), surface(kDown, 2.5),
                                         surface({1, 0, 0}, 1.0)};
  EXPECT_EQ(classify(surfaces, kDown),
            (std::vector{PlaneClass::kTable, PlaneClass::kFloor, PlaneClass::kCeiling, PlaneClass::kWall}));
}

TEST(Classify, GravityMayHaveAnyLengthAndDirection) {
  const std::vector<Surface> surfaces = {surface({0, -1, 0}, 0.0), surface({0, 1, 0}, 0.0), surface(kUp, 0.0)};
  EXPECT_EQ(classify(surfaces, Eigen::Vector3d(0.0, 9.81, 0.0)),
            (std::vector{PlaneClass::kFloor, PlaneClass::kCeiling, PlaneClass::kWall}));
}

TEST(Classify, FifteenDegreesAreTheLimitOnAllSides) {
  const std::vector<Surface> surfaces = {surface(leaning(14.0), 0.0),  surface(leaning(16.0), 0.0),
                                         surface(leaning(74.0), 0.0),  surface(leaning(76.0), 0.0),
                                         surface(leaning(104.0), 0.0), surface(leaning(106.0), 0.0),
                                         surface(leaning(164.0), 0.0), surface(leaning(166.0), 0.0)};
  EXPECT_EQ(classify(surfaces, kDown),
            (std::vector{PlaneClass::kFloor, PlaneClass::kSlope, PlaneClass::kSlope, PlaneClass::kWall,
                         PlaneClass::kWall, PlaneClass::kSlope, PlaneClass::kSlope, PlaneClass::kCeiling}));
}

TEST(Classify, AStepOfAFloorIsFloorAndAShelfBelowItNoFloor) {
  const std::vector<Surface> surfaces = {surface(kUp, 0.0, 10.0), surface(kUp, 0.25, 2.0), surface(kUp, 0.35, 2.0),
                                         surface(kUp, -0.4, 0.1)};
  const auto classes = classify(surfaces, kDown);
  EXPECT_EQ(classes[0], PlaneClass::kFloor);
  EXPECT_EQ(classes[1], PlaneClass::kFloor);
  EXPECT_EQ(classes[2], PlaneClass::kTable);
  // Too small to be what heights are measured from: else the true floor, 0.4 m above it, would be a table.
  EXPECT_EQ(classes[3], PlaneClass::kFloor);
}

TEST(Classify, WithoutALargeSurfaceThereIsNoFloor) {
  const std::vector<Surface> surfaces = {surface(kUp, 0.4, 0.2)};
  EXPECT_EQ(classify(surfaces, kDown), std::vector{PlaneClass::kTable});
}

}  // namespace
}  // namespace planemap

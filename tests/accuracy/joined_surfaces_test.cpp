// Which true surfaces count as one: only what no mapper could tell apart.

#include "joined_surfaces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace planemap::accuracy {
namespace {

using simulation::Surface;

/// An upright strip of 2 m height that begins at (from_m, offset_m), as wide as said and turned by an angle.
Surface strip(double from_m, double width_m, double offset_m, double angle_deg) {
  const double angle_rad = angle_deg * std::numbers::pi / 180.0;
  const Eigen::Vector3d along(std::cos(angle_rad), std::sin(angle_rad), 0.0);
  const Eigen::Vector3d a(from_m, offset_m, 0.0);
  const Eigen::Vector3d b = a + width_m * along;
  const Eigen::Vector3d up(0.0, 0.0, 2.0);
  Surface surface;
  surface.plane = Plane::through(a, along.cross(Eigen::Vector3d::UnitZ()));
  surface.pieces_m = {{a, b, b + up, a + up}};
  return surface;
}

/// A door's leaf that ends at the origin.
Surface leaf() {
  return strip(-0.9, 0.9, 0.0, 0.0);
}

TEST(JoinedSurfaces, WhatTouchesAndDiffersByLessThanTheResolutionIsOne) {
  EXPECT_TRUE(are_one_surface(leaf(), strip(0.03, 0.12, 0.0, 0.0)));
  EXPECT_TRUE(are_one_surface(leaf(), strip(0.03, 0.12, 0.0005, 0.5)));  // ends 1.5 mm before it
  EXPECT_TRUE(are_one_surface(strip(0.03, 0.12, 0.0005, 0.5), leaf())) << "in either order";
}

TEST(JoinedSurfaces, AGreaterAngleOffsetOrGapKeepsThemApart) {
  EXPECT_FALSE(are_one_surface(leaf(), strip(0.03, 0.08, 0.0, 1.1))) << "an angle that a map can tell";
  EXPECT_FALSE(are_one_surface(leaf(), strip(0.03, 0.12, 0.0021, 0.0))) << "an offset that a map can tell";
  EXPECT_FALSE(are_one_surface(leaf(), strip(0.03, 0.12, 0.0005, 0.9)))
      << "within the angle, but its end is 2.4 mm off";
  EXPECT_FALSE(are_one_surface(leaf(), strip(0.05, 0.12, 0.0, 0.0))) << "they don't touch";
  Surface back = strip(0.03, 0.12, 0.0, 0.0);
  back.plane = Plane::through(Eigen::Vector3d::Zero(), -back.plane.normal());
  EXPECT_FALSE(are_one_surface(leaf(), back)) << "they face opposite ways";
  Surface facet = strip(0.03, 0.12, 0.0, 0.0);
  facet.facet = true;
  EXPECT_FALSE(are_one_surface(leaf(), facet));
}

TEST(JoinedSurfaces, EachSmallOneCountsAsPartOfTheLargestAndChainsDoNotGrow) {
  // Three strips in a row, each 0.7 degrees from the one before: the last is told from the first.
  const std::vector<Surface> surfaces = {strip(0.12, 0.1, 0.0007, 1.4), leaf(), strip(0.0, 0.11, 0.0, 0.7)};
  ASSERT_TRUE(are_one_surface(surfaces[1], surfaces[2]));
  ASSERT_TRUE(are_one_surface(surfaces[2], surfaces[0]));
  ASSERT_FALSE(are_one_surface(surfaces[1], surfaces[0]));
  EXPECT_EQ(joined_surfaces(surfaces), (std::vector<std::size_t>{0, 1, 1}));
}

}  // namespace
}  // namespace planemap::accuracy

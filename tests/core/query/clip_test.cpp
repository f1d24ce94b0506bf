#include "query/clip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "query/random_map.hpp"

namespace planemap {
namespace {

using Eigen::Vector2d;

const Ring kSquare = {{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {0.0, 4.0}};

TEST(Clip, CutsASquareInHalf) {
  std::vector<Ring> rings = {kSquare};
  clip(rings, {{1.0, 0.0}, 1.5});
  const auto polygons = polygons_of(rings);
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_EQ(polygons[0].outer.size(), 4U);
  EXPECT_DOUBLE_EQ(area_m2(polygons), 6.0);
  clip(rings, {{-1.0, 0.0}, -1.5});  // what is left of it is on the border
  EXPECT_NEAR(area_m2(polygons_of(rings)), 0.0, 1e-12);
}

TEST(Clip, KeepsOrDropsWhatIsOnOneSide) {
  std::vector<Ring> rings = {kSquare};
  clip(rings, {{0.0, 1.0}, 4.0});
  ASSERT_EQ(rings.size(), 1U);
  EXPECT_EQ(rings[0], kSquare);
  clip(rings, {{0.0, 0.0}, 1.0});  // holds all points
  EXPECT_EQ(rings.size(), 1U);
  clip(rings, {{0.0, 0.0}, -1.0});  // holds none
  EXPECT_TRUE(rings.empty());
}

TEST(Clip, ACombFallsIntoItsTeeth) {
  // Three teeth of 1 m by 2 m on a back of 5 m by 1 m.
  const Ring comb = {{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  std::vector<Ring> rings = {comb};
  clip(rings, {{0.0, -1.0}, -1.5});  // above 1.5
  const auto polygons = polygons_of(rings);
  ASSERT_EQ(polygons.size(), 3U);
  for (const Polygon& tooth : polygons) EXPECT_DOUBLE_EQ(area_m2(std::span(&tooth, 1)), 1.5);
}

TEST(Clip, AHoleThatIsCutBecomesABay) {
  const Ring hole = {{1.0, 1.0}, {1.0, 3.0}, {3.0, 3.0}, {3.0, 1.0}};
  std::vector<Ring> rings = {kSquare, hole};
  clip(rings, {{1.0, 0.0}, 2.0});
  auto polygons = polygons_of(rings);
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_TRUE(polygons[0].holes.empty());
  EXPECT_DOUBLE_EQ(area_m2(polygons), 6.0);

  rings = {kSquare, hole};
  clip(rings, {{1.0, 0.0}, 3.5});  // beside the hole
  polygons = polygons_of(rings);
  ASSERT_EQ(polygons.size(), 1U);
  ASSERT_EQ(polygons[0].holes.size(), 1U);
  EXPECT_DOUBLE_EQ(area_m2(polygons), 10.0);

  rings = {kSquare, hole};
  clip(rings, {{1.0, 0.0}, 3.0});  // along the hole's side
  EXPECT_DOUBLE_EQ(area_m2(polygons_of(rings)), 8.0);
}

/// Area of what of the rings' inside is in a half-plane, by Green's theorem: the integral of min(x, offset) dy along
/// the rings, x along the half-plane's normal. Boost.Geometry 1.74 is no twin: what only touches the border is at times
/// cut away by it, or kept where it is beyond.
double cut_area_m2(const std::vector<Ring>& rings, const HalfPlane& half_plane) {
  const Vector2d& normal = half_plane.normal;
  const Vector2d along(-normal.y(), normal.x());
  double area = 0.0;
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector2d& a = ring[i];
      const Vector2d& b = ring[(i + 1) % ring.size()];
      const double dy = along.dot(b - a);
      const double from = half_plane.excess(a);
      const double to = half_plane.excess(b);
      if (from <= 0.0 && to <= 0.0) {
        area += dy * 0.5 * (from + to);
      } else if (from <= 0.0 || to <= 0.0) {
        const double low = std::min(from, to);
        area += dy * 0.5 * low * low / (low - std::max(from, to));
      }
    }
  }
  return area;
}

TEST(Clip, LeavesTheAreaThatIsInTheHalfPlaneOnRandomPolygons) {
  testing::Random random(31);
  int cut = 0;
  for (int round = 0; round < 1000; ++round) {
    const auto map = testing::random_map(random, 10, 0);
    for (const DescribedPlane& plane : map.planes) {
      const std::vector<Ring> whole = rings_of(plane.outline->polygons);
      const double angle_rad = random.uniform(0.0, 2.0 * M_PI);
      HalfPlane half_plane{{std::cos(angle_rad), std::sin(angle_rad)}, random.uniform(-2.0, 2.0)};
      // Through a corner, or along a side, at times.
      if (!whole.empty() && random.one_in(3)) {
        const Vector2d side = (whole[0][1] - whole[0][0]).normalized();
        if (random.one_in(2)) half_plane.normal = (random.one_in(2) ? 1.0 : -1.0) * Vector2d(side.y(), -side.x());
        half_plane.offset_m = half_plane.normal.dot(whole[0][0]);
      }
      const double expected_m2 = cut_area_m2(whole, half_plane);
      const double whole_m2 = area_m2(plane.outline->polygons);
      std::vector<Ring> rings = whole;
      clip(rings, half_plane);
      const auto polygons = polygons_of(rings);
      ASSERT_NEAR(area_m2(polygons), expected_m2, 1e-9);
      std::vector<Ring> rest = whole;
      clip(rest, {-half_plane.normal, -half_plane.offset_m});
      ASSERT_NEAR(area_m2(polygons_of(rest)), whole_m2 - expected_m2, 1e-9);
      for (const Polygon& polygon : polygons) {
        ASSERT_GT(signed_area_m2(polygon.outer), 0.0);
        for (const Vector2d& p : polygon.outer) ASSERT_LE(half_plane.excess(p), 1e-12);
        for (const Ring& hole : polygon.holes) ASSERT_LT(signed_area_m2(hole), 0.0);
      }
      if (expected_m2 > 1e-3 && expected_m2 < whole_m2 - 1e-3) ++cut;
    }
  }
  EXPECT_GT(cut, 2500);
}

}  // namespace
}  // namespace planemap

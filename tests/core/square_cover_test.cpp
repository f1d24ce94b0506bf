#include "square_cover.hpp"

#include <gtest/gtest.h>

#include <boost/polygon/polygon.hpp>
#include <random>

namespace planemap {
namespace {

namespace bp = boost::polygon;
using RasterSet = bp::polygon_90_set_data<int>;
using Centres = std::vector<std::array<int, 2>>;

/// The union as its definition says.
RasterSet union_of_squares(const Centres& centres, int half_size) {
  RasterSet set;
  for (const auto& [u, v] : centres) {
    set.insert(bp::rectangle_data<int>(u - half_size, v - half_size, u + half_size, v + half_size));
  }
  return set;
}

RasterSet union_of_cover(const Centres& centres, int half_size) {
  RasterSet set;
  for (const RasterRectangle& r : square_cover(centres, half_size)) {
    set.insert(bp::rectangle_data<int>(r.left, r.bottom, r.right, r.top));
  }
  return set;
}

TEST(SquareCover, NothingIsCoveredByNothing) {
  EXPECT_TRUE(square_cover({}, 16).empty());
}

TEST(SquareCover, ASingleSquareIsKept) {
  const Centres centres{{-3, 5}};
  EXPECT_EQ(union_of_cover(centres, 16), union_of_squares(centres, 16));
}

TEST(SquareCover, HasTheUnionOfTheSquares) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const int half_size = std::uniform_int_distribution<int>(1, 20)(random);
    const int extent = std::uniform_int_distribution<int>(0, 12 * half_size)(random);
    std::uniform_int_distribution<int> place(-extent, extent);  // about zero, where division must not round to it
    Centres centres(std::uniform_int_distribution<std::size_t>(1, 400)(random));
    for (auto& centre : centres) centre = {place(random), place(random)};
    ASSERT_EQ(union_of_cover(centres, half_size), union_of_squares(centres, half_size)) << "trial " << trial;
  }
}

TEST(SquareCover, AFullRectangleCostsItsBorder) {
  constexpr int kHalfSize = 16;
  constexpr int kSide = 100;
  std::mt19937_64 random(7);
  std::uniform_int_distribution<int> jitter(0, kHalfSize - 1);
  Centres centres;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      centres.push_back({column * kHalfSize + jitter(random), row * kHalfSize + jitter(random)});
    }
  }
  EXPECT_EQ(square_cover(centres, kHalfSize).size(), kSide + 4u * (kSide - 1));
  EXPECT_EQ(union_of_cover(centres, kHalfSize), union_of_squares(centres, kHalfSize));
}

TEST(OccupiedRows, AreUnbrokenRowsOfBins) {
  // Columns 0, 1 and 3 of row 0; column -1 of row -1.
  const Centres points{{50, 3}, {0, 0}, {31, 15}, {2, 9}, {-1, -16}};
  const auto rows = occupied_rows(points, 16);
  ASSERT_EQ(rows.size(), 3u);
  const auto as_array = [](const RasterRectangle& r) { return std::array{r.left, r.bottom, r.right, r.top}; };
  EXPECT_EQ(as_array(rows[0]), (std::array{-16, -16, 0, 0}));
  EXPECT_EQ(as_array(rows[1]), (std::array{0, 0, 32, 16}));
  EXPECT_EQ(as_array(rows[2]), (std::array{48, 0, 64, 16}));
}

}  // namespace
}  // namespace planemap

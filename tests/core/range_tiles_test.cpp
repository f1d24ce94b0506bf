#include "planemap/range_tiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace planemap {
namespace {

/// A Kinect's image in which everything is 3 m away: a tile is 9 by 9 pixels, of which every second one is read.
DepthScan flat_image() {
  DepthScan scan;
  scan.intrinsics = {640, 480, 585.0, 585.0, 319.5, 239.5};
  scan.depth.assign(640UL * 480UL, 3000);
  return scan;
}

std::uint16_t& pixel(DepthScan& scan, int u, int v) {
  return scan.depth[static_cast<std::size_t>(v * scan.intrinsics.width + u)];
}

TEST(RangeTiles, CutsAnImageIntoSquares) {
  RangeTiles tiles;
  tiles.read(flat_image());
  EXPECT_EQ(tiles.width(), 72);   // 71.1
  EXPECT_EQ(tiles.height(), 54);  // 53.3
  EXPECT_DOUBLE_EQ(tiles.fx(), 65.0);
  EXPECT_NEAR(tiles.cx(), 320.0 / 9.0, 1e-12);  // the axis is 320 pixels from the left border
  EXPECT_FLOAT_EQ(tiles.nearest_m(0, 0), 3.0F);
  EXPECT_FLOAT_EQ(tiles.nearest_m(71, 53), 3.0F);
  EXPECT_FLOAT_EQ(tiles.farthest_m(), 3.0F);
  EXPECT_EQ(tiles.seen().min(), Eigen::Vector2i(0, 0));
  EXPECT_EQ(tiles.seen().max(), Eigen::Vector2i(71, 53));
}

TEST(RangeTiles, ATileIsFreeUpToTheNearestOfItsPixels) {
  DepthScan scan = flat_image();
  pixel(scan, 9 * 20 + 4, 9 * 10 + 2) = 1250;
  RangeTiles tiles;
  tiles.read(scan);
  EXPECT_FLOAT_EQ(tiles.nearest_m(20, 10), 1.25F);
  EXPECT_FLOAT_EQ(tiles.nearest_m(21, 10), 3.0F);
  EXPECT_FLOAT_EQ(tiles.nearest_m(20, 11), 3.0F);
}

TEST(RangeTiles, ATileWithManySilentPixelsIsNotKnownToBeFree) {
  for (const std::uint16_t silent : {kNoReturn, kNoReturnHigh}) {
    DepthScan scan = flat_image();
    for (int v = 90; v < 99; ++v) {
      for (int u = 180; u < 182; ++u) pixel(scan, u, v) = silent;  // 5 of the 25 that are read
      for (int u = 270; u < 274; ++u) pixel(scan, u, v) = silent;  // 10 of them
    }
    RangeTiles tiles;
    tiles.read(scan);
    EXPECT_FLOAT_EQ(tiles.nearest_m(20, 10), 3.0F);
    EXPECT_FALSE(tiles.is_silent(20, 10));
    EXPECT_TRUE(tiles.is_silent(30, 10));
    EXPECT_FLOAT_EQ(tiles.nearest_m(30, 10), 3.0F);  // of what came back
  }
}

TEST(RangeTiles, AnImageWithoutReturnsSeesNothing) {
  DepthScan scan = flat_image();
  std::fill(scan.depth.begin(), scan.depth.end(), kNoReturn);
  RangeTiles tiles;
  tiles.read(scan);
  EXPECT_EQ(tiles.farthest_m(), 0.0F);
  EXPECT_TRUE(tiles.seen().isEmpty());
}

TEST(RangeTiles, SmallImagesHaveTilesOfAPixel) {
  DepthScan scan;
  scan.intrinsics = {4, 2, 5.0, 5.0, 1.5, 0.5};
  scan.depth.assign(8, 1000);
  scan.depth[5] = kNoReturn;
  RangeTiles tiles;
  tiles.read(scan);
  EXPECT_EQ(tiles.width(), 4);
  EXPECT_EQ(tiles.height(), 2);
  EXPECT_FLOAT_EQ(tiles.nearest_m(0, 0), 1.0F);
  EXPECT_TRUE(tiles.is_silent(1, 1));
  EXPECT_TRUE(std::isinf(tiles.nearest_m(1, 1)));
}

TEST(RangeTiles, ACloudIsProjectedFortyFiveDegreesToEachSide) {
  PointScan scan;
  const auto add = [&](float x, float y, float z, int times) {
    for (int i = 0; i < times; ++i) scan.xyz_m.insert(scan.xyz_m.end(), {x, y, z});
  };
  add(0.01F, 0.01F, 2.0F, 3);    // just right of and below the axis: tile 64, 64
  add(0.005F, 0.005F, 1.0F, 1);  // in the same tile, nearer
  add(-1.98F, 0.01F, 2.0F, 2);   // the leftmost tile, too few
  add(2.1F, 0.0F, 2.0F, 5);      // beyond 45 degrees
  add(0.0F, 0.0F, -2.0F, 5);     // behind the sensor
  add(std::numeric_limits<float>::quiet_NaN(), 0.0F, 2.0F, 5);
  add(0.0F, 0.0F, std::numeric_limits<float>::quiet_NaN(), 5);
  RangeTiles tiles;
  tiles.read(scan);
  EXPECT_EQ(tiles.width(), 128);
  EXPECT_EQ(tiles.height(), 128);
  EXPECT_FLOAT_EQ(tiles.nearest_m(64, 64), 1.0F);
  for (int v = 0; v < 128; ++v) {
    for (int u = 0; u < 128; ++u) EXPECT_EQ(tiles.is_silent(u, v), u != 64 || v != 64) << u << ' ' << v;
  }
}

}  // namespace
}  // namespace planemap

#include "planemap/wear.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kCellM = 0.08;

// One cell and hand-made images: the rule itself.

/// A cell on the axis of a sensor that stands in the origin and looks along z; its points are all in its middle.
class OneCell {
 public:
  OneCell() : grid(kCellM), ref(grid.find_or_add(grid.index_of({0.01, 0.01, 2.0}))) {
    Cell& cell = grid.writable(ref);
    cell.sums.count = 100.0;
    cell.sums.error_m2 = Eigen::Vector3f::Constant(100.0F * 1e-6F);  // a millimetre each
  }
  /// Everything at one depth, seen at a time.
  static DepthScan flat(double depth_m, double time_s) {
    DepthScan scan;
    scan.utime = std::llround(1e6 * (100.0 + time_s));
    scan.intrinsics = {640, 480, 585.0, 585.0, 319.5, 239.5};
    scan.depth.assign(640UL * 480UL, static_cast<std::uint16_t>(std::lround(1000.0 * depth_m)));
    return scan;
  }
  bool goes(const DepthScan& scan) {
    const auto found = wear.look(grid, scan, Isometry3d::Identity(), {});
    EXPECT_TRUE(found.empty() || (found.size() == 1 && found[0] == ref));
    return !found.empty();
  }
  /// Whether the cell goes when the same image is seen for two seconds.
  bool goes_before(DepthScan scan) {
    bool gone = false;
    for (int i = 0; i < 20; ++i) {
      scan.utime = std::llround(1e6 * (100.0 + 0.1 * i));
      gone |= goes(scan);
    }
    return gone;
  }

  UncertainGrid grid;
  CellRef ref;
  Wear wear{WearConfig{}, SensorConfig{}, kCellM};
};

TEST(Wear, ACellGoesWhenItWasSeenThroughForASecond) {
  OneCell cell;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(cell.goes(OneCell::flat(3.0, 0.1 * i))) << i;
  EXPECT_TRUE(cell.goes(OneCell::flat(3.0, 1.0)));
  EXPECT_FALSE(cell.goes(OneCell::flat(3.0, 1.1)));  // it is counted from zero again
}

TEST(Wear, ALookAfterALongTimeCountsForAQuarterOfASecond) {
  OneCell cell;
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(cell.goes(OneCell::flat(3.0, 60.0 * i))) << i;
  EXPECT_TRUE(cell.goes(OneCell::flat(3.0, 240.0)));
}

TEST(Wear, FastScansCountForTheirTime) {
  OneCell cell;  // 2,400 scans a second, 416 us apart: fractions of a millisecond add up
  int scans = 0;
  while (!cell.goes(OneCell::flat(3.0, 0.000416 * scans)) && scans < 5000) ++scans;
  EXPECT_NEAR(0.000416 * scans, 1.0, 0.002);
}

TEST(Wear, AClockThatIsSetBackTellsNoTime) {
  OneCell cell;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(cell.goes(OneCell::flat(3.0, -0.1 * i)));
}

TEST(Wear, WhatIsJustBehindTheCellKeepsIt) {
  // The cell's middle is at 2.04 m, its cube with the clearance reaches 6 cm behind, and half a tile is 2.04 / 65 / 2 =
  // 1.6 cm more. At 2.14 m sigma is hypot(1.425e-3, 0.125 / (585 * 0.075 * sqrt(12))) * 2.14^2 = 7.5 mm, with the
  // cell's 1.7 mm together 7.7 mm: what is no farther than 2.040 + 0.060 + 0.016 + 3 * 0.0077 = 2.139 m keeps it.
  EXPECT_FALSE(OneCell().goes_before(OneCell::flat(1.5, 0.0)));
  EXPECT_FALSE(OneCell().goes_before(OneCell::flat(2.04, 0.0)));
  EXPECT_FALSE(OneCell().goes_before(OneCell::flat(2.136, 0.0)));
  EXPECT_TRUE(OneCell().goes_before(OneCell::flat(2.142, 0.0)));
}

TEST(Wear, ErrorsOfTheCellsOwnPointsKeepItToo) {
  OneCell sure;
  OneCell unsure;
  unsure.grid.writable(unsure.ref).sums.error_m2 = {0.0F, 0.0F, 100.0F * 0.03F * 0.03F};
  EXPECT_TRUE(sure.goes_before(OneCell::flat(2.18, 0.0)));
  EXPECT_FALSE(unsure.goes_before(OneCell::flat(2.18, 0.0)));  // 2.116 + 3 * 0.031 = 2.209
  EXPECT_TRUE(unsure.goes_before(OneCell::flat(2.23, 0.0)));
}

/// What is 3 m away, but for a square of pixels about (u, v).
DepthScan with_square(std::uint16_t depth, int u, int v, int half) {
  DepthScan scan = OneCell::flat(3.0, 0.0);
  for (int y = v - half; y <= v + half; ++y) {
    for (int x = u - half; x <= u + half; ++x) scan.depth[static_cast<std::size_t>(y * 640 + x)] = depth;
  }
  return scan;
}

TEST(Wear, ASurfaceAnywhereInTheCellKeepsIt) {
  // The outline of cube and clearance is 585 * 0.06 / 2.04 = 17 pixels about the cell's middle, which is 12 right of
  // the image's and 12 below: it lies 4 cm from the axis. Tiles are 9 pixels wide, and those that the outline crosses
  // count as a whole.
  const int u = 320 + 12;
  const int v = 240 + 12;
  EXPECT_FALSE(OneCell().goes_before(with_square(2000, u, v, 1)));
  EXPECT_FALSE(OneCell().goes_before(with_square(2000, u + 16, v, 1)));
  EXPECT_FALSE(OneCell().goes_before(with_square(1500, u - 16, v, 1)));  // it may be hidden there
  EXPECT_FALSE(OneCell().goes_before(with_square(2000, u, v - 16, 1)));
  EXPECT_TRUE(OneCell().goes_before(with_square(2000, u + 40, v, 1)));
  EXPECT_TRUE(OneCell().goes_before(with_square(2000, u, v - 40, 1)));
}

TEST(Wear, PixelsWithoutReturnKeepIt) {
  EXPECT_FALSE(OneCell().goes_before(with_square(kNoReturn, 332, 252, 8)));
  EXPECT_FALSE(OneCell().goes_before(with_square(kNoReturnHigh, 332, 252, 8)));
  EXPECT_FALSE(OneCell().goes_before(OneCell::flat(0.0, 0.0)));
}

TEST(Wear, AFewPixelsWithoutReturnDontKeepASurfaceThatIsLookedInTheFace) {
  OneCell unknown;
  OneCell face;
  OneCell edge_on;
  face.grid.writable(face.ref).normal = {0.0F, 0.0F, -1.0F};
  edge_on.grid.writable(edge_on.ref).normal = {1.0F, 0.0F, -0.1F};
  const DepthScan hole = with_square(kNoReturn, 345, 252, 4);  // beside the middle, about one tile of twenty
  EXPECT_FALSE(unknown.goes_before(hole));
  EXPECT_FALSE(edge_on.goes_before(hole));
  EXPECT_TRUE(face.goes_before(hole));
  EXPECT_FALSE(face.goes_before(with_square(kNoReturn, 350, 252, 18)));  // a third of its tiles
}

TEST(Wear, ACellAtTheBorderOfTheImageStays) {
  OneCell cell;
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(std::atan(319.5 / 585.0), Vector3d::UnitY()).toRotationMatrix();
  for (int i = 0; i < 40; ++i) {
    EXPECT_TRUE(cell.wear.look(cell.grid, OneCell::flat(3.0, 0.1 * i), T, {}).empty());
  }
}

TEST(Wear, PointsInTheCellStartTheCountAnew) {
  OneCell cell;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(cell.goes(OneCell::flat(3.0, 0.1 * i)));
  const std::vector<CellChange> changes = {{cell.ref, {}}};
  cell.grid.writable(cell.ref).working = 0;
  EXPECT_TRUE(cell.wear.look(cell.grid, OneCell::flat(3.0, 1.0), Isometry3d::Identity(), changes).empty());
  cell.grid.writable(cell.ref).working = Cell::kNotWorking;
  for (int i = 11; i < 20; ++i) EXPECT_FALSE(cell.goes(OneCell::flat(3.0, 0.1 * i))) << i;
  EXPECT_TRUE(cell.goes(OneCell::flat(3.0, 2.0)));
}

TEST(Wear, ACellWithoutPointsIsNotFound) {
  OneCell cell;
  cell.grid.writable(cell.ref) = Cell{};
  EXPECT_FALSE(cell.goes_before(OneCell::flat(3.0, 0.0)));
}

TEST(Wear, ManyFineCellsAreLookedAtInTurn) {
  // Blocks of 8 cm: the view holds more than are tried for one scan, and each is tried in its turn.
  UncertainGrid grid(0.01);
  const CellRef ref = grid.find_or_add(grid.index_of({0.0, 0.0, 2.0}));
  grid.writable(ref).sums.count = 100.0;
  Wear wear(WearConfig{}, SensorConfig{}, 0.01);
  double gone_s = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 600 && !std::isfinite(gone_s); ++i) {
    if (!wear.look(grid, OneCell::flat(3.0, i / 30.0), Isometry3d::Identity(), {}).empty()) gone_s = i / 30.0;
  }
  EXPECT_GE(gone_s, 1.0);
  EXPECT_LE(gone_s, 6.0);
}

}  // namespace
}  // namespace planemap

#include "planemap/uncertain_grid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <stdexcept>

namespace planemap {
namespace {

TEST(UncertainGrid, IndexRoundsDownBelowZero) {
  const UncertainGrid grid(0.1);
  EXPECT_EQ(grid.index_of(Eigen::Vector3d(-0.01, 0.0, 0.0)), CellIndex(-1, 0, 0));
  EXPECT_EQ(grid.index_of(Eigen::Vector3d(0.05, 0.15, -0.15)), CellIndex(0, 1, -2));
}

TEST(UncertainGrid, GeometricCentreIsTheMiddleOfTheCube) {
  EXPECT_TRUE(
      UncertainGrid(0.1).geometric_centre_m(CellIndex(-1, 0, 2)).isApprox(Eigen::Vector3d(-0.05, 0.05, 0.25), 1e-12));
}

TEST(UncertainGrid, CellSizeMustBeAPositiveNumber) {
  EXPECT_THROW(UncertainGrid(0.0), std::invalid_argument);
  EXPECT_THROW(UncertainGrid(-1.0), std::invalid_argument);
}

TEST(Block, PlacesAndIndicesGoThereAndBackBelowZeroToo) {
  for (const CellIndex& index :
       {CellIndex(0, 0, 0), CellIndex(-1, -8, -9), CellIndex(7, 8, 15), CellIndex(-100, 33, 5)}) {
    EXPECT_EQ(cell_at(block_of(index), place_of(index)), index);
  }
  EXPECT_EQ(block_of(CellIndex(-1, 7, 8)), BlockIndex(-1, 0, 1));
}

TEST(UncertainGrid, FindsWhatWasAddedAndNothingElse) {
  UncertainGrid grid(0.08);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> coordinate(-30, 30);
  std::map<std::array<int, 3>, CellRef> added;
  for (int i = 0; i < 3000; ++i) {
    const std::array<int, 3> key{coordinate(random), coordinate(random), coordinate(random)};
    const CellRef ref = grid.find_or_add({key[0], key[1], key[2]});
    const auto [at, is_new] = added.emplace(key, ref);
    EXPECT_EQ(at->second, ref);
  }
  EXPECT_EQ(grid.cell_count(), added.size());
  for (const auto& [key, ref] : added) {
    const CellIndex index(key[0], key[1], key[2]);
    ASSERT_TRUE(grid.find(index).has_value());
    EXPECT_EQ(*grid.find(index), ref);
    EXPECT_EQ(grid.index_of(ref), index);
  }
  EXPECT_FALSE(grid.find({31, 0, 0}).has_value());
}

TEST(UncertainGrid, NeighboursOfDepthDAreThoseWithinDStepsAcrossBlocksToo) {
  UncertainGrid grid(1.0);
  for (int z = -4; z <= 4; ++z) {
    for (int y = -4; y <= 4; ++y) {
      for (int x = -4; x <= 4; ++x) grid.find_or_add({x, y, z});
    }
  }
  for (const int depth : {1, 2}) {
    std::set<std::array<int, 3>> seen;
    grid.for_each_neighbour(*grid.find({0, 0, 0}), depth, [&](CellRef ref) {
      const CellIndex index = grid.index_of(ref);
      EXPECT_LE(index.cwiseAbs().maxCoeff(), depth);
      seen.insert({index.x(), index.y(), index.z()});
    });
    EXPECT_EQ(seen.size(), depth == 1 ? 27U : 125U);  // (2d + 1)^3, the cell itself included
  }
}

TEST(UncertainGrid, SharedBlocksAreCopiedBeforeTheyChange) {
  UncertainGrid grid(1.0);
  const CellRef ref = grid.find_or_add({0, 0, 0});
  grid.writable(ref).plane = 1;
  BlockTable before;
  grid.share(before);
  grid.writable(ref).plane = 2;
  grid.find_or_add({1, 0, 0});
  EXPECT_EQ(before[0]->cell(0).plane, 1U);
  EXPECT_EQ(before[0]->size(), 1U);
  EXPECT_EQ(grid.cell(ref).plane, 2U);
  EXPECT_EQ(grid.cell_count(), 2U);
}

TEST(UncertainGrid, UnchangedBlocksStayShared) {
  UncertainGrid grid(1.0);
  grid.find_or_add({0, 0, 0});
  const CellRef other = grid.find_or_add({100, 0, 0});
  BlockTable before;
  grid.share(before);
  grid.writable(other).plane = 1;
  BlockTable after;
  grid.share(after);
  EXPECT_EQ(before[0], after[0]);
  EXPECT_NE(before[1], after[1]);
}

TEST(UncertainGrid, APlaceMayHaveASecondCell) {
  UncertainGrid grid(0.08);
  const CellRef first = grid.find_or_add({7, -1, 3});
  EXPECT_FALSE(grid.sibling(first));
  const CellRef second = grid.find_or_add_second(first);
  EXPECT_NE(first, second);
  EXPECT_EQ(grid.find_or_add_second(first), second);
  EXPECT_EQ(grid.cell_count(), 2U);
  EXPECT_EQ(grid.index_of(second), CellIndex(7, -1, 3));
  EXPECT_EQ(grid.sibling(first), second);
  EXPECT_EQ(grid.sibling(second), first);
  EXPECT_EQ(grid.find({7, -1, 3}), first);
  EXPECT_TRUE(grid.cell(second).is_second);
}

TEST(UncertainGrid, NeighboursComeWithTheirSecondCellsRightBehindThem) {
  UncertainGrid grid(0.08);
  const CellRef home = grid.find_or_add({0, 0, 0});
  const CellRef beside = grid.find_or_add({-1, 0, 0});
  const CellRef behind = grid.find_or_add_second(beside);
  const CellRef own = grid.find_or_add_second(home);
  std::vector<CellRef> seen;
  grid.for_each_neighbour(own, 1, [&](CellRef ref) { seen.push_back(ref); });
  EXPECT_EQ(seen, (std::vector<CellRef>{beside, behind, home, own}));
}

TEST(Cell, BegunAnewKeepsItsPlaceAndItsLabel) {
  UncertainGrid grid(0.08);
  const CellRef first = grid.find_or_add({0, 0, 0});
  const CellRef second = grid.find_or_add_second(first);
  Cell& cell = grid.writable(second);
  cell.sums.count = 5.0;
  cell.normal = Eigen::Vector3f::UnitX();
  cell.plane = 4;
  cell.begin_anew();
  EXPECT_EQ(cell.sums.count, 0.0);
  EXPECT_FALSE(cell.has_normal());
  EXPECT_EQ(cell.plane, 4U);
  EXPECT_EQ(grid.sibling(second), first);
  EXPECT_EQ(grid.sibling(first), second);
}

}  // namespace
}  // namespace planemap

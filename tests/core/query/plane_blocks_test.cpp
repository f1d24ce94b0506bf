#include "plane_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <planemap/block.hpp>
#include <set>

#include "query/random_map.hpp"

namespace planemap {
namespace {

void expect_planes_of(const BlockTable& blocks, const PlaneBlocks& found) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    std::set<PlaneSlot> planes;
    for (std::size_t k = 0; k < blocks[i]->size(); ++k) planes.insert(blocks[i]->cell(k).plane);
    planes.erase(kNoSlot);
    const auto here = found.planes_in(i);
    EXPECT_TRUE(std::equal(here.begin(), here.end(), planes.begin(), planes.end())) << i;
  }
}

TEST(PlaneBlocks, KnowsThePlanesOfEachBlockAlsoWhereSomeHaveChanged) {
  testing::Random random(81);
  for (int round = 0; round < 50; ++round) {
    const auto map = testing::random_map(random, 10, 300);
    BlockTable blocks;
    for (const auto& block : map.snapshot->blocks()) blocks.push_back(block);
    ASSERT_GT(blocks.size(), 2U);
    BlockTable before;
    for (std::size_t i = 0; i + 1 < blocks.size(); ++i) before.push_back(blocks[i]);  // one is to come
    const PlaneBlocks early(before);
    expect_planes_of(before, early);
    auto changed = std::make_shared<Block>(*blocks[1]);
    changed->cell(0).plane = 77;
    blocks.set(1, std::move(changed));
    const PlaneBlocks late(blocks, &early);
    expect_planes_of(blocks, late);
    expect_planes_of(blocks, PlaneBlocks(blocks));
    EXPECT_EQ(late.planes_in(1).back(), 77U);
  }
}

}  // namespace
}  // namespace planemap

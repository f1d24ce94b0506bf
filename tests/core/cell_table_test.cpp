#include "cell_table.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

namespace planemap {
namespace {

TEST(CellTable, AnswersAsAMapDoesWhileItGrows) {
  CellTable table;
  std::map<std::tuple<int, int, int>, std::uint32_t> twin;
  std::mt19937 random(5);
  std::uniform_int_distribution<int> near(-20, 20);
  for (std::uint32_t i = 0; i < 50'000; ++i) {
    const auto [x, y, z] = std::tuple(near(random), near(random), near(random));
    const auto found = twin.emplace(std::tuple(x, y, z), i);
    std::uint32_t& number = table(x, y, z);
    EXPECT_EQ(number == CellTable::kNone, found.second);
    if (found.second) number = i;
    EXPECT_EQ(table(x, y, z), found.first->second);
  }
  EXPECT_GT(twin.size(), 20'000U);
}

TEST(CellTable, TellsTheFarthestCellsApart) {
  constexpr std::int32_t kLow = -CellTable::kLimit;
  constexpr std::int32_t kHigh = CellTable::kLimit - 1;
  CellTable table;
  std::uint32_t next = 0;
  for (const std::int32_t x : {kLow, kHigh}) {
    for (const std::int32_t y : {kLow, -1, 0, kHigh}) {
      for (const std::int32_t z : {kLow, kHigh}) {
        EXPECT_EQ(table(x, y, z), CellTable::kNone);
        table(x, y, z) = next++;
      }
    }
  }
  EXPECT_EQ(table(kLow, kLow, kLow), 0U);
  EXPECT_EQ(table(kHigh, kHigh, kHigh), next - 1);
}

TEST(CellTable, HoldsNothingOnceItIsCleared) {
  CellTable table;
  table(1, 2, 3) = 7;
  table.clear();
  EXPECT_EQ(table(1, 2, 3), CellTable::kNone);
}

}  // namespace
}  // namespace planemap

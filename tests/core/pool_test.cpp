#include "planemap/pool.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace planemap {
namespace {

struct Thing {
  std::vector<int> numbers;
  int forgotten = 0;
  void forget() {
    ++forgotten;
    numbers.clear();
  }
};

TEST(Pool, GivesWhatNobodyHoldsAnyMoreWithItsMemory) {
  Pool<Thing> pool;
  auto first = pool.take();
  const Thing* address = first.get();
  first->numbers.assign(100, 7);
  const auto second = pool.take();
  EXPECT_NE(second.get(), address) << "somebody holds that one";
  first.reset();
  EXPECT_EQ(pool.waiting(), 1U);
  const auto again = pool.take();
  EXPECT_EQ(again.get(), address);
  EXPECT_EQ(again->forgotten, 1);
  EXPECT_TRUE(again->numbers.empty());
  EXPECT_EQ(again->numbers.capacity(), 100U);
}

TEST(Pool, ItsObjectsMayOutliveIt) {
  std::shared_ptr<Thing> thing;
  {
    Pool<Thing> pool;
    thing = pool.take([] { return std::make_unique<Thing>(Thing{{1, 2}, 0}); });
  }
  EXPECT_EQ(thing->numbers.size(), 2U);
}

TEST(Pool, TheLastHolderMayBeOnAnotherThread) {
  Pool<Thing> pool;
  for (int i = 0; i < 1000; ++i) {
    auto thing = pool.take();
    thing->numbers.push_back(i);
    std::thread([held = std::shared_ptr<const Thing>(std::move(thing)), i] {
      EXPECT_EQ(held->numbers.back(), i);
    }).join();
  }
  EXPECT_EQ(pool.waiting(), 1U);
}

TEST(Pool, TrimFreesHalfOfWhatWaitedAllTheTime) {
  Pool<Thing> pool;
  std::vector<std::shared_ptr<Thing>> held;
  for (int i = 0; i < 10; ++i) held.push_back(pool.take());
  held.clear();
  EXPECT_EQ(pool.waiting(), 10U);
  pool.trim();
  EXPECT_EQ(pool.waiting(), 10U) << "just before all were in use";
  for (int i = 0; i < 4; ++i) held.push_back(pool.take());
  held.clear();
  pool.trim();
  EXPECT_EQ(pool.waiting(), 7U) << "of the 6 that nobody took";
  pool.trim();
  pool.trim();
  pool.trim();
  EXPECT_EQ(pool.waiting(), 0U);
  EXPECT_NE(pool.take(), nullptr);
}

}  // namespace
}  // namespace planemap

#include "planemap/paged_sequence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace planemap {
namespace {

using Sequence = PagedSequence<std::shared_ptr<const int>>;

std::vector<int> values(const Sequence& sequence) {
  std::vector<int> all;
  std::transform(sequence.begin(), sequence.end(), std::back_inserter(all), [](const auto& item) { return *item; });
  return all;
}

TEST(PagedSequence, WhatWasSharedNeverChanges) {
  std::mt19937_64 random(1);
  Sequence sequence;
  std::vector<int> twin;
  std::vector<std::pair<Sequence, std::vector<int>>> shared(8);
  for (int i = 0; i < 3000; ++i) {
    if (twin.empty() || random() % 3 == 0) {
      sequence.push_back(std::make_shared<const int>(i));
      twin.push_back(i);
    } else {
      const std::size_t at = random() % twin.size();
      sequence.set(at, std::make_shared<const int>(i));
      twin[at] = i;
    }
    if (random() % 20 == 0) {
      auto& [copy, values_then] = shared[random() % shared.size()];
      sequence.share(copy);
      values_then = twin;
    }
  }
  EXPECT_EQ(values(sequence), twin);
  for (const auto& [copy, values_then] : shared) EXPECT_EQ(values(copy), values_then);
}

TEST(PagedSequence, OnlyAChangedPageIsCopied) {
  Sequence sequence;
  for (int i = 0; i < 200; ++i) sequence.push_back(std::make_shared<const int>(i));
  Sequence before;
  sequence.share(before);
  sequence.set(70, std::make_shared<const int>(-1));
  Sequence after;
  sequence.share(after);
  EXPECT_TRUE(after.shares_page(0, before));
  EXPECT_FALSE(after.shares_page(1, before));
  EXPECT_TRUE(after.shares_page(2, before));
  EXPECT_FALSE(after.shares_page(4, before)) << "there is none";
}

TEST(PagedSequence, APageThatNobodyHasLetsGoOfItsItems) {
  auto item = std::make_shared<const int>(1);
  const std::weak_ptr<const int> watched = item;
  Sequence sequence;
  sequence.push_back(std::move(item));
  Sequence reader;
  sequence.share(reader);
  sequence.set(0, std::make_shared<const int>(2));
  EXPECT_FALSE(watched.expired()) << "the reader has it";
  reader.clear();
  EXPECT_TRUE(watched.expired());
}

}  // namespace
}  // namespace planemap

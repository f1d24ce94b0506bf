#include "mapping/helper_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <thread>

#include "mapping/offline_builder.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

TEST(HelperThread, DoesEachWorkOnItsOwnThread) {
  HelperThread helper;
  std::thread::id first;
  for (int i = 0; i < 200; ++i) {
    int done = 0;
    std::thread::id by;
    const auto work = [&] {
      done = i + 1;
      by = std::this_thread::get_id();
    };
    do_both(
        &helper, [] {}, work);
    EXPECT_EQ(done, i + 1);
    if (i == 0) first = by;
    EXPECT_EQ(by, first);
    EXPECT_NE(by, std::this_thread::get_id());
  }
}

TEST(HelperThread, BothPartsRunAtOnce) {
  HelperThread helper;
  std::atomic<bool> here = false;
  std::atomic<bool> there = false;
  do_both(
      &helper,
      [&] {
        here = true;
        here.notify_one();
        there.wait(false);
      },
      [&] {
        here.wait(false);
        there = true;
        there.notify_one();
      });
  EXPECT_TRUE(here && there);
}

TEST(HelperThread, IsThereForTwoThreadsOnly) {
  EXPECT_EQ(helper_thread_for(1), nullptr);
  EXPECT_NE(helper_thread_for(2), nullptr);
}

TEST(HelperThread, TheServicesMapIsTheSame) {
  const auto map_of = [](int threads) {
    ServiceConfig config;
    config.mapping.threads = threads;
    OfflineBuilder builder(config, 5);
    for (int i = 0; i < 20; ++i) {
      builder.add_event("POSE", encoded(pose_message(1'000'000 + i * 66'667)));
      builder.add_event("PLANEMAP_SCAN", encoded(wall_message(1'000'000 + i * 66'667, i)));
    }
    builder.finish();
    return builder.snapshot();
  };
  const auto one = map_of(1);
  const auto two = map_of(2);
  ASSERT_EQ(one->planes().size(), 1U);
  ASSERT_EQ(two->planes().size(), 1U);
  EXPECT_EQ(one->planes()[0]->covariance, two->planes()[0]->covariance);
  EXPECT_EQ(one->planes()[0]->plane.d(), two->planes()[0]->plane.d());
  EXPECT_EQ(one->cell_count(), two->cell_count());
}

}  // namespace
}  // namespace planemap::service

// Threads that leave the core to others.
#include "common/background.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <thread>

namespace planemap::service {
namespace {

int nice_of_this_thread() {
  return getpriority(PRIO_PROCESS, 0);
}

TEST(Background, IsOfTheCallingThreadAlone) {
  const int before = nice_of_this_thread();
  if (before > 14) GTEST_SKIP() << "the tests run in the background themselves";
  int in_thread = 0;
  std::thread([&] {
    run_in_background(5);
    in_thread = nice_of_this_thread();
  }).join();
  EXPECT_EQ(in_thread, before + 5);
  EXPECT_EQ(nice_of_this_thread(), before);
}

TEST(Background, EndsAtTheLeastShare) {
  int in_thread = 0;
  std::thread([&] {
    for (int i = 0; i < 3; ++i) run_in_background(19);
    in_thread = nice_of_this_thread();
  }).join();
  EXPECT_EQ(in_thread, 19);
}

}  // namespace
}  // namespace planemap::service

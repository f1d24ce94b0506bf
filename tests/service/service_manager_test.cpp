// What planemapd tells systemd, heard by a socket of the test's own.

#include "service_manager.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "support/notify_socket.hpp"

namespace planemap::service {
namespace {

using std::chrono::microseconds;

TEST(ServiceManager, IsToldOfTheWholeLife) {
  const NotifySocket socket;
  setenv("NOTIFY_SOCKET", socket.path().c_str(), 1);
  ServiceManager manager;
  manager.ready("3 planes\nand more");
  EXPECT_EQ(socket.next(), "READY=1\nSTATUS=3 planes and more");
  manager.status("4 planes");
  EXPECT_EQ(socket.next(), "STATUS=4 planes");
  manager.beat();
  EXPECT_EQ(socket.next(), "WATCHDOG=1");
  manager.stopping();
  EXPECT_EQ(socket.next(), "STOPPING=1\nSTATUS=ending");
  EXPECT_EQ(socket.next(std::chrono::milliseconds(0)), "");
  unsetenv("NOTIFY_SOCKET");
}

TEST(ServiceManager, NeedsNone) {
  unsetenv("NOTIFY_SOCKET");
  ServiceManager manager;
  manager.ready("nobody hears it");
  manager.beat();
  EXPECT_FALSE(manager.beat_period());
}

TEST(ServiceManager, WantsABeatInHalfOfItsTime) {
  setenv("WATCHDOG_USEC", "3000000", 1);
  EXPECT_EQ(ServiceManager().beat_period(), microseconds(1500000));
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(ServiceManager().beat_period()) << "meant for another process";
  unsetenv("WATCHDOG_PID");
  setenv("WATCHDOG_USEC", "soon", 1);
  EXPECT_FALSE(ServiceManager().beat_period());
  unsetenv("WATCHDOG_USEC");
}

}  // namespace
}  // namespace planemap::service

// What planemapd tells systemd, heard by a socket of the test's own.

#include "service_manager.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>

#include "support/temporary_folder.hpp"

namespace planemap::service {
namespace {

using std::chrono::microseconds;

/// Listens as systemd does.
class NotifySocket {
 public:
  NotifySocket()
      : path_((folder_.path() / "notify").string()), socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    ::close(socket_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  /// The next message; empty: none is there.
  std::string next() const {
    pollfd polled{socket_, POLLIN, 0};
    if (::poll(&polled, 1, 0) != 1) return {};
    std::array<char, 4096> bytes{};
    const auto count = ::recv(socket_, bytes.data(), bytes.size(), 0);
    return count > 0 ? std::string(bytes.data(), static_cast<std::size_t>(count)) : std::string();
  }

 private:
  TemporaryFolder folder_;
  std::string path_;
  int socket_;
};

TEST(ServiceManager, IsToldOfTheWholeLife) {
  const NotifySocket socket;
  ServiceManager manager;
  manager.ready("3 planes\nand more");
  EXPECT_EQ(socket.next(), "READY=1\nSTATUS=3 planes and more");
  manager.status("4 planes");
  EXPECT_EQ(socket.next(), "STATUS=4 planes");
  manager.beat();
  EXPECT_EQ(socket.next(), "WATCHDOG=1");
  manager.stopping();
  EXPECT_EQ(socket.next(), "STOPPING=1\nSTATUS=ending");
  EXPECT_EQ(socket.next(), "");
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

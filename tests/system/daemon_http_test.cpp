// The daemon itself over HTTP, and what it tells the service manager.
#include <csignal>
#include <nlohmann/json.hpp>
#include <string>

#include "harness/network.hpp"
#include "harness/system_test.hpp"
#include "support/http_client.hpp"
#include "support/notify_socket.hpp"

namespace planemap::system_test {
namespace {

constexpr std::uint16_t kPort = 7671;

class DaemonHttp : public SystemTest {
 protected:
  /// Until its servers listen: it publishes its status earlier.
  void start_ready_daemon() {
    ASSERT_NO_FATAL_FAILURE(start_daemon({}, {"env", "NOTIFY_SOCKET=" + socket_.path(), "WATCHDOG_USEC=1000000"}));
    ASSERT_EQ(socket_.next(), "READY=1\nSTATUS=0 planes, 0 cells, 0 scans mapped");
  }

  const NotifySocket socket_;
};

TEST_F(DaemonHttp, ShowsAMovingMapAndEndsWithinASecondWhileItIsWatched) {
  ASSERT_NO_FATAL_FAILURE(start_ready_daemon());
  const auto kinect = start("kinect", {program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5",
                                       "--rate", "15", "--loop", "--quiet", "--lcm-url", kLcmUrl});
  TcpClient watcher(kPort);
  watcher.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  for (const char* event : {"event: hello", "event: delta", "event: pose", "event: delta", "event: status"}) {
    ASSERT_NE(watcher.read_until(event).find(event), std::string::npos) << event << kinect->output();
  }
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") >= 10; }, 30s)) << kinect->output();
  EXPECT_EQ(http_get(kPort, "/api/v1/scan").status, 200);
  EXPECT_FALSE(nlohmann::json::parse(http_get(kPort, "/api/v1/planes").body).at("planes").empty());
  EXPECT_EQ(http_get(kPort, "/healthz").body, "ok\n");
  EXPECT_NE(http_get(kPort, "/metrics").body.find("planemap_scan_seconds_count"), std::string::npos);
  const auto before = std::chrono::steady_clock::now();
  daemon_->send_signal(SIGTERM);
  EXPECT_TRUE(watcher.is_closed_within(1s));
  EXPECT_EQ(daemon_->wait_for(5s), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - before, 2s);
}

TEST_F(DaemonHttp, SaysWhatToDoWhereItsPortIsTaken) {
  ASSERT_NO_FATAL_FAILURE(start_ready_daemon());
  const Finished second = run({program("planemapd"), "--lcm-url", kLcmUrl, "--set", "grpc.listen="});
  EXPECT_EQ(second.exit_code, 1);
  const std::string said = second.out + second.err;
  EXPECT_NE(said.find("http.listen: cannot listen on 127.0.0.1 port 7671: Address already in use; stop what listens "
                      "there (another planemapd?), or choose another port"),
            std::string::npos)
      << said;
  EXPECT_EQ(http_get(kPort, "/readyz").body, "ok\n") << "the first one goes on";
}

TEST_F(DaemonHttp, TellsTheServiceManagerOfItsLife) {
  ASSERT_NO_FATAL_FAILURE(start_ready_daemon());
  EXPECT_EQ(socket_.next(), "WATCHDOG=1");
  EXPECT_EQ(socket_.next(), "WATCHDOG=1");
  daemon_->send_signal(SIGTERM);
  std::string message = socket_.next();
  while (message == "WATCHDOG=1") message = socket_.next();
  EXPECT_EQ(message, "STOPPING=1\nSTATUS=ending");
  EXPECT_EQ(daemon_->wait_for(5s), 0);
}

}  // namespace
}  // namespace planemap::system_test

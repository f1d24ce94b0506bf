// planemapd ends and is started again while others watch it: they go on with the new map by themselves, and soon.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <planemap/client/grpc_map_client.hpp>
#include <string>
#include <thread>

#include "harness/network.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

using Clock = std::chrono::steady_clock;

/// From when the new daemon is heard. By gRPC's own ways of connecting again it took up to eight.
constexpr auto kHealsWithin = 3s;

class Restart : public SystemTest {
 protected:
  /// Ends planemapd as init does, and starts it at once.
  void restart() {
    daemon_->send_signal(SIGTERM);
    ASSERT_EQ(daemon_->wait_for(10s), 0) << daemon_->output();
    stop_daemon();
    ASSERT_NO_FATAL_FAILURE(start_daemon());
  }
};

/// Sits in next() on a thread of its own, until it has failed.
class Sitter {
 public:
  explicit Sitter(client::MapClient& client)
      : watch_(client.watch()), thread_([this](const std::stop_token& stop) { sit(stop); }) {}

  int new_maps() const { return new_maps_; }
  bool has_failed() const { return has_failed_; }
  /// @pre has_failed()
  const std::string& why() const { return why_; }

 private:
  void sit(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const auto change = watch_->next(500ms);
      if (!change) {
        why_ = change.error().message;
        has_failed_ = true;
        return;
      }
      if (change->new_map) ++new_maps_;
    }
  }

  std::unique_ptr<client::MapWatch> watch_;
  std::atomic<int> new_maps_ = 0;
  std::atomic<bool> has_failed_ = false;
  std::string why_;
  std::jthread thread_;
};

TEST_F(Restart, AWatchThatSitsInNextTakesEachNewMap) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  const auto client = client::GrpcMapClient::connect(client::kDefaultServer);
  ASSERT_TRUE(client) << client.error().message;
  const Sitter sitter(**client);
  ASSERT_TRUE(bus_->wait_until([&] { return sitter.new_maps() == 1 || sitter.has_failed(); }, 10s));
  for (int lives = 2; lives <= 5; ++lives) {
    ASSERT_NO_FATAL_FAILURE(restart());
    const auto begin = Clock::now();
    ASSERT_TRUE(bus_->wait_until([&] { return sitter.new_maps() == lives || sitter.has_failed(); }, 20s));
    ASSERT_FALSE(sitter.has_failed()) << "life " << lives << ": " << sitter.why();
    EXPECT_LT(Clock::now() - begin, kHealsWithin) << "life " << lives;
    const auto status = (*client)->status(5s);
    EXPECT_TRUE(status) << "other questions are answered again, too: " << status.error().message;
  }
}

TEST_F(Restart, TheCommandLineGoesOnWatching) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  const auto watch = start("watch", {program("planemap"), "watch", "--changes", "4"});
  const auto lines = [&] {
    const std::string said = watch->output();
    return std::count(said.begin(), said.end(), '\n');
  };
  ASSERT_TRUE(bus_->wait_until([&] { return lines() == 1; }, 10s)) << watch->output();
  for (int lives = 2; lives <= 4; ++lives) {
    ASSERT_NO_FATAL_FAILURE(restart());
    const auto begin = Clock::now();
    ASSERT_TRUE(bus_->wait_until([&] { return lines() == lives || !watch->running(); }, 20s)) << watch->output();
    EXPECT_EQ(lines(), lives) << watch->output();
    EXPECT_LT(Clock::now() - begin, kHealsWithin) << "life " << lives;
  }
  EXPECT_EQ(watch->wait_for(5s), 0) << watch->output();
}

}  // namespace
}  // namespace planemap::system_test

// How planemapd starts, ends, and says what is wrong.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "harness/messages.hpp"
#include "harness/network.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

class Lifecycle : public SystemTest {};
class Unrouted : public UnroutedTest {};

void expect_signal_ends_cleanly(Process& daemon, int signal) {
  const auto before = std::chrono::steady_clock::now();
  daemon.send_signal(signal);
  const auto exit_code = daemon.wait_for(5s);
  ASSERT_TRUE(exit_code) << "planemapd still runs";
  EXPECT_EQ(*exit_code, 0);
  EXPECT_LT(std::chrono::steady_clock::now() - before, 3s);
}

TEST_F(Lifecycle, SigtermEndsItCleanlyWhileScansStream) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  const auto kinect = start("kinect", {program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5",
                                       "--rate", "15", "--loop", "--quiet", "--lcm-url", kLcmUrl});
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") >= 10; }, 30s)) << kinect->output();
  expect_signal_ends_cleanly(*daemon_, SIGTERM);
  EXPECT_TRUE(kinect->running());
  expect_signal_ends_cleanly(*kinect, SIGINT);
}

TEST_F(Lifecycle, SigintEndsItCleanlyWhenIdle) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  expect_signal_ends_cleanly(*daemon_, SIGINT);
}

TEST_F(Lifecycle, SaysWhyNothingIsMappedAtMostOnceInFiveSeconds) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  // Scans, but never a pose: for long enough that the reason is due more than once.
  std::int64_t utime = 1'700'000'000'000'000;
  std::int32_t seq = 0;
  const auto end = std::chrono::steady_clock::now() + 14s;
  while (std::chrono::steady_clock::now() < end) {
    const planemap_lcm::depth_scan_t scan = wall_message(utime, ++seq);
    bus_->lcm().publish("PLANEMAP_SCAN", &scan);
    utime += 100'000;
    bus_->listen_for(100ms);
  }
  ASSERT_TRUE(bus_->status());
  EXPECT_NE(bus_->status()->idle_reason.find("pose"), std::string::npos) << bus_->status()->idle_reason;
  EXPECT_NE(bus_->status()->idle_reason.find("POSE"), std::string::npos) << "the reason names the channel";
  // "2024-05-01 10:00:05.123 warning nothing is being mapped: ...": the seconds of the day of each.
  const std::regex line_pattern(R"((\d\d):(\d\d):(\d\d)\.(\d{3}) \S*warning\S* +nothing is being mapped: .*pose)");
  std::vector<double> said_s;
  const std::string log = daemon_->output();
  for (std::sregex_iterator line(log.begin(), log.end(), line_pattern); line != std::sregex_iterator(); ++line) {
    said_s.push_back(std::stod((*line)[1]) * 3600 + std::stod((*line)[2]) * 60 + std::stod((*line)[3]) +
                     std::stod((*line)[4]) / 1000);
  }
  ASSERT_GE(said_s.size(), 2u) << log;
  for (std::size_t i = 1; i < said_s.size(); ++i) {
    const double apart_s = said_s[i] - said_s[i - 1] + (said_s[i] < said_s[i - 1] ? 86400 : 0);
    EXPECT_GE(apart_s, 4.99) << log;
  }
}

TEST_F(Unrouted, DaemonSaysWhatToDoWithoutMulticastRoute) {
  const Finished daemon = run({program("planemapd"), "--lcm-url", kLcmUrl});
  EXPECT_EQ(daemon.exit_code, 1);
  EXPECT_NE((daemon.out + daemon.err).find("ip route add 224.0.0.0/4 dev lo"), std::string::npos)
      << daemon.out << daemon.err;
}

TEST_F(Unrouted, KinectBridgeSaysWhatToDoWithoutMulticastRoute) {
  const Finished bridge =
      run({program("planemap-kinect-bridge"), "--simulate", "apartment", "--frames", "2", "--lcm-url", kLcmUrl});
  EXPECT_EQ(bridge.exit_code, 1);
  EXPECT_NE((bridge.out + bridge.err).find("route"), std::string::npos) << bridge.out << bridge.err;
}

TEST_F(Lifecycle, CliSaysThatNoDaemonAnswers) {
  const Finished status = run({program("planemap"), "status", "--lcm-url", kLcmUrl, "--timeout", "0.5"});
  EXPECT_EQ(status.exit_code, 3);
  EXPECT_NE(status.err.find("planemapd"), std::string::npos) << status.err;
}

TEST_F(Unrouted, WrongConfigurationListsEveryProblemAndWhere) {
  const std::string path = (scratch_ / "wrong.yaml").string();
  std::ofstream(path) << "grid:\n  cell_size_m: lots\n  cel_size: 0.1\nnonsense: 1\n";
  const Finished daemon = run({program("planemapd"), "--config", path});
  EXPECT_EQ(daemon.exit_code, 2);
  const std::string said = daemon.out + daemon.err;
  for (const char* where : {"wrong.yaml:2", "wrong.yaml:3", "wrong.yaml:4"}) {
    EXPECT_NE(said.find(where), std::string::npos) << where << " is missing in:\n" << said;
  }
}

TEST_F(Unrouted, PrintedConfigurationIsRead) {
  const Finished printed = run({program("planemapd"), "--set", "grid.cell_size_m=0.05", "--print-config"});
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  const std::string path = (scratch_ / "printed.yaml").string();
  std::ofstream(path) << printed.out;
  const Finished again = run({program("planemapd"), "--config", path, "--print-config"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, printed.out);
  EXPECT_NE(printed.out.find("cell_size_m: 0.05"), std::string::npos);
}

}  // namespace
}  // namespace planemap::system_test

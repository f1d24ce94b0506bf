// What goes wrong around planemapd: the disk, the clock, the network, the machine, its clients. Mapping goes on, or
// goes on again, and what is wrong is said.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "harness/network.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

namespace fs = std::filesystem;

class Faults : public SystemTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(SystemTest::SetUp());
    if (IsSkipped()) return;
    fs::create_directory(switches_);
  }
  /// With a map file and, on the way to the system, the shim.
  void start_mapping(const std::vector<std::string>& more = {}, std::vector<std::string> before = {}) {
    std::vector<std::string> arguments = {"--map", map_, "--set", "store.interval_s=0.2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const char* set = std::getenv("ASAN_OPTIONS");
    const std::string asan_options = set == nullptr ? "" : set;
    before.insert(before.end(), {"env", "LD_PRELOAD=" PLANEMAP_FAULT_SHIM, "PLANEMAP_FAULTS=" + switches_.string(),
                                 "ASAN_OPTIONS=" + asan_options + ":verify_asan_link_order=0"});
    ASSERT_NO_FATAL_FAILURE(start_daemon(arguments, before));
    start_kinect();
    ASSERT_TRUE(bus_->wait_until(
        [&] { return bus_->counter("scans.mapped") >= 5 && bus_->counter("store.commits") >= 2; }, 60s))
        << kinect_->output();
  }
  void start_kinect() {
    kinect_ = start("kinect", {program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5", "--rate",
                               "10", "--loop", "--quiet", "--lcm-url", kLcmUrl});
  }
  void TearDown() override {
    kinect_.reset();
    SystemTest::TearDown();
  }
  void expect_mapping_goes_on() {
    const auto mapped = bus_->counter("scans.mapped");
    ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") > mapped + 10; }, 60s))
        << "mapping stopped";
  }
  bool wait_until_said(const std::string& text) {
    return bus_->wait_until([&] { return daemon_->output().find(text) != std::string::npos; }, 60s);
  }
  Finished planemap(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), program("planemap"));
    return run(arguments);
  }
  /// received = mapped + waiting + dropped + rejected
  void expect_every_scan_counted() const {
    EXPECT_EQ(bus_->counter("scans.received"), bus_->counter("scans.mapped") + bus_->counter("scans.waiting") +
                                                   bus_->counters_beginning("scans.dropped.") +
                                                   bus_->counters_beginning("scans.rejected."))
        << bus_->describe();
  }

  const fs::path switches_ = scratch_ / "faults";
  const std::string map_ = (scratch_ / "flat.planemap").string();
  std::unique_ptr<Process> kinect_;
};

TEST_F(Faults, ADiskWithErrorsIsSaidAndTheMapIsSavedOnceItIsWell) {
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  std::ofstream(switches_ / "io_error").flush();
  ASSERT_TRUE(bus_->wait_until([&] { return !bus_->status()->degraded.empty(); }, 30s));
  EXPECT_EQ(bus_->status()->degraded, map_ + ": the map cannot be saved: disk I/O error");
  EXPECT_EQ(bus_->counter("store.degraded"), 1);
  ASSERT_NO_FATAL_FAILURE(expect_mapping_goes_on());
  EXPECT_NE(planemap({"status"}).out.find("the map cannot be saved: disk I/O error"), std::string::npos);
  EXPECT_EQ(planemap({"info", map_}).exit_code, 0) << "what was committed before is whole";
  fs::remove(switches_ / "io_error");
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->status()->degraded.empty(); }, 30s)) << bus_->status()->degraded;
  EXPECT_TRUE(wait_until_said("flat.planemap: the map is saved again"));
  EXPECT_NE(daemon_->output().find("disk I/O error; mapping goes on, the map is not being kept"), std::string::npos);
  const Finished saved = planemap({"save"});
  EXPECT_EQ(saved.out, "the map is saved\n") << saved.err;
  EXPECT_EQ(planemap({"info", map_}).exit_code, 0);
}

TEST_F(Faults, SigtermInTheMiddleOfASyncWaitsForItAndLosesNothing) {
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  const std::string fifo = (switches_ / "stall").string();
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  int writer = -1;  // can be opened once the saver waits at the other end
  ASSERT_TRUE(bus_->wait_until([&] { return (writer = open(fifo.c_str(), O_WRONLY | O_NONBLOCK)) >= 0; }, 30s));
  ASSERT_NO_FATAL_FAILURE(expect_mapping_goes_on());  // the mapper does not wait for the disk
  daemon_->send_signal(SIGTERM);
  const auto revision = bus_->status()->revision;
  EXPECT_FALSE(daemon_->wait_for(300ms)) << "it ended without its map";
  fs::remove(fifo);
  close(writer);
  ASSERT_EQ(daemon_->wait_for(20s), 0) << daemon_->output();
  const Finished info = planemap({"info", map_});
  EXPECT_NE(info.out.find("whole, closed in good order"), std::string::npos) << info.out << info.err;
  const auto at = info.out.find(", revision ");
  ASSERT_NE(at, std::string::npos) << info.out;
  EXPECT_GE(std::stoll(info.out.substr(at + 11)), revision);
}

TEST_F(Faults, AClockThatStepsForthAndBackChangesNothing) {
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  const auto epoch = bus_->status()->epoch;
  for (const int seconds : {7200, -7200}) {
    const auto utime = bus_->status()->utime;
    const auto commits = bus_->counter("store.commits");
    std::ofstream(switches_ / "clock.new") << seconds;
    fs::rename(switches_ / "clock.new", switches_ / "clock");
    const auto stepped = [&] { return std::abs(bus_->status()->utime - utime) > 3'600'000'000; };
    ASSERT_TRUE(bus_->wait_until(stepped, 30s)) << "statuses go on, with the clock's new time";
    ASSERT_NO_FATAL_FAILURE(expect_mapping_goes_on());
    EXPECT_TRUE(bus_->wait_until([&] { return bus_->counter("store.commits") > commits; }, 30s));
    EXPECT_EQ(bus_->status()->degraded, "");
    EXPECT_EQ(bus_->status()->idle_reason, "");
    EXPECT_EQ(bus_->status()->epoch, epoch);
    expect_every_scan_counted();
  }
  const Finished reset = planemap({"reset"});  // two hours before the map's epoch, by the clock
  EXPECT_EQ(reset.exit_code, 0) << reset.err;
  EXPECT_TRUE(bus_->wait_until([&] { return bus_->status()->epoch > epoch; }, 30s)) << "epochs do not go back";
}

TEST_F(Faults, AnInterfaceThatGoesAndComesBackIsHeardAgain) {
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  const auto mapped = bus_->counter("scans.mapped");
  ASSERT_EQ(std::system("ip link set lo down"), 0);
  EXPECT_TRUE(wait_until_said("could not be sent on PLANEMAP_STATUS; is there a route for multicast?"));
  EXPECT_TRUE(daemon_->running());
  ASSERT_EQ(std::system("ip link set lo up"), 0);
  add_multicast_route();
  if (!kinect_->running()) start_kinect();
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("publish.failed") > 0; }, 30s)) << "it is heard again";
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") > mapped + 10; }, 60s)) << bus_->describe();
  EXPECT_EQ(bus_->status()->degraded, "");
  expect_every_scan_counted();
}

TEST_F(Faults, AProcessThatStoodStillGoesOnWithTheNewestAndCountsWhatItMissed) {
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  const auto epoch = bus_->status()->epoch;
  daemon_->send_signal(SIGSTOP);
  bus_->listen_for(5s);  // 50 scans of 614 kB: more than the receive buffer holds
  daemon_->send_signal(SIGCONT);
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counters_beginning("scans_lost_before_arrival.") > 0; }, 30s))
      << bus_->describe();
  ASSERT_NO_FATAL_FAILURE(expect_mapping_goes_on());
  EXPECT_GT(bus_->counter("lcm.kernel_drops"), 0);
  EXPECT_EQ(bus_->status()->epoch, epoch);
  EXPECT_EQ(bus_->status()->degraded, "");
  EXPECT_EQ(bus_->status()->idle_reason, "");
  expect_every_scan_counted();
}

/// A connection to planemapd's gRPC that says nothing.
int idle_connection() {
  const int client = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7670);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return client;
  close(client);
  return -1;
}

TEST_F(Faults, WithoutDescriptorsClientsAreRefusedInWordsAndServedAgainLater) {
  // The test's network is its own, and so are the ports.
  ASSERT_NO_FATAL_FAILURE(start_mapping({"--set", "grpc.max_connections=1000"}, {"prlimit", "--nofile=160:160"}));
  std::vector<int> clients;
  clients.reserve(300);
  for (int i = 0; i < 300; ++i) clients.push_back(idle_connection());
  EXPECT_TRUE(
      wait_until_said("gRPC: a client was refused: no file descriptor is left (raise the limit of open files)"));
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("grpc.connections.refused") > 0; }, 30s));
  ASSERT_NO_FATAL_FAILURE(expect_mapping_goes_on());
  for (const int client : clients) {
    if (client >= 0) close(client);
  }
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("grpc.connections.open") == 0; }, 30s)) << bus_->describe();
  const Finished status = planemap({"status", "--server", "127.0.0.1:7670"});
  EXPECT_EQ(status.exit_code, 0) << status.err;
  EXPECT_EQ(planemap({"save"}).out, "the map is saved\n");
}

TEST_F(Faults, ClientsThatAreGoneWithoutAWordLoseTheirPlace) {
  ASSERT_NO_FATAL_FAILURE(start_mapping({"--set", "grpc.max_connections=2"}));
  const int silent = idle_connection();   // its handshake never comes
  const int settled = idle_connection();  // a client of HTTP/2, with nothing to ask
  ASSERT_GE(silent, 0);
  ASSERT_GE(settled, 0);
  const std::string hello("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0\0\0\0\4\1\0\0\0\0", 42);
  ASSERT_EQ(send(settled, hello.data(), hello.size(), 0), static_cast<ssize_t>(hello.size()));
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("grpc.connections.open") == 2; }, 30s));
  const Finished refused = planemap({"status", "--server", "127.0.0.1:7670", "--timeout", "1"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_TRUE(wait_until_said("gRPC: a client was refused: there are 2 connections (grpc.max_connections = 2)"));
  cut_off_tcp(7670);
  // The one is given 10 s for its handshake, the other 40 s for an answer to a ping.
  EXPECT_TRUE(bus_->wait_until([&] { return bus_->counter("grpc.connections.open") == 0; }, 90s)) << bus_->describe();
  mend_tcp();
  ASSERT_NO_FATAL_FAILURE(expect_mapping_goes_on());
  const Finished status = planemap({"status", "--server", "127.0.0.1:7670"});
  EXPECT_EQ(status.exit_code, 0) << status.err;
  close(silent);
  close(settled);
}

/// Copies the events of a log from scan number `first` to before `last`.
void cut_log(const std::string& from, const std::string& to, int first, int last) {
  lcm::LogFile in(from, "r");
  lcm::LogFile out(to, "w");
  ASSERT_TRUE(in.good() && out.good());
  int scans = 0;
  while (const lcm::LogEvent* event = in.readNextEvent()) {
    if (event->channel == "PLANEMAP_SCAN") ++scans;
    if (scans <= first || scans > last) continue;
    lcm::LogEvent copy = *event;
    ASSERT_EQ(out.writeEvent(&copy), 0);
  }
}

TEST_F(Faults, WhatATenfoldLoadDropsIsCountedExactly) {
  constexpr int kScans = 200;
  constexpr int kCalm = 10;  // the last ones come slowly: what is lost is known by the next scan that comes
  const auto file = [&](const char* name) { return (scratch_ / name).string(); };
  const Finished made = run({program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5", "--frames",
                             std::to_string(kScans), "--rate", "30", "--log", file("all.lcm"), "--quiet"},
                            240s);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  ASSERT_NO_FATAL_FAILURE(cut_log(file("all.lcm"), file("flood.lcm"), 0, kScans - kCalm));
  ASSERT_NO_FATAL_FAILURE(cut_log(file("all.lcm"), file("calm.lcm"), kScans - kCalm, kScans));
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  const Finished flood = run({"lcm-logplayer", "--speed=10", "--lcm-url", kLcmUrl, file("flood.lcm")}, 120s);
  ASSERT_EQ(flood.exit_code, 0) << flood.err;
  const Finished calm = run({"lcm-logplayer", "--speed=0.2", "--lcm-url", kLcmUrl, file("calm.lcm")}, 120s);
  ASSERT_EQ(calm.exit_code, 0) << calm.err;
  const auto known = [&] {
    return bus_->counter("scans.received") + bus_->counters_beginning("scans_lost_before_arrival.");
  };
  ASSERT_TRUE(bus_->wait_until([&] { return known() >= kScans && bus_->counter("scans.waiting") <= 1; }, 60s))
      << bus_->describe();
  const auto handled = bus_->counter("scans.mapped") + bus_->counter("scans.waiting");
  const auto dropped = bus_->counters_beginning("scans.dropped.") + bus_->counters_beginning("scans.rejected.") +
                       bus_->counters_beginning("scans_lost_before_arrival.");
  EXPECT_EQ(dropped, kScans - handled) << bus_->describe();
  EXPECT_GT(dropped, 0) << "that was no overload";
  EXPECT_GT(handled, 0);
  expect_every_scan_counted();
  std::printf("of %d scans at 300 Hz %lld were handled, %lld dropped\n", kScans, static_cast<long long>(handled),
              static_cast<long long>(dropped));
}

}  // namespace
}  // namespace planemap::system_test

// deploy/demo.sh as a newcomer runs it, on the machine's own multicast and in a namespace where there is none; only the
// executables are taken from this build.
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/network.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

class Demo : public SystemTest {};
class DemoWithoutRoute : public UnroutedTest {};

std::vector<std::string> demo(const std::filesystem::path& results, const std::string& seconds,
                              const std::vector<std::string>& more = {}) {
  std::vector<std::string> command = {project_file("deploy/demo.sh"),
                                      "--no-install",
                                      "--bin",
                                      PLANEMAP_BIN_DIR,
                                      "--seconds",
                                      seconds,
                                      "--out",
                                      results.string()};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

/// No process is left of those that a demo started: they are in its process group.
bool all_gone(pid_t demo_pid) {
  return kill(-demo_pid, 0) != 0;
}

void expect_results(const std::filesystem::path& results, const std::string& output) {
  for (const char* name : {"floorplan.svg", "cells.ply", "planes.json", "truth.json"}) {
    EXPECT_TRUE(std::filesystem::exists(results / name)) << name;
    EXPECT_NE(output.find((results / name).string()), std::string::npos) << "the demo does not name " << name;
  }
  const auto planes = nlohmann::json::parse(read_file(results / "planes.json"), nullptr, false);
  ASSERT_FALSE(planes.is_discarded());
  EXPECT_GE(planes.at("planes").size(), 5u);
  EXPECT_NE(output.find("wall"), std::string::npos) << "the table of planes is missing in:\n" << output;
  EXPECT_NE(output.find("scans/s"), std::string::npos) << "the progress is missing in:\n" << output;
}

TEST_F(Demo, RunsOnTheMachinesOwnMulticast) {
  bus_.reset();
  const auto results = scratch_ / "results";
  const auto demo_run = start("demo", demo(results, "10", {"--host"}));
  ASSERT_EQ(demo_run->wait_for(90s), 0) << demo_run->output();
  expect_results(results, demo_run->output());
  EXPECT_TRUE(all_gone(demo_run->pid()));
}

TEST_F(Demo, LeavesNothingBehindWhenInterrupted) {
  const auto demo_run = start("demo", demo(scratch_ / "results", "60", {"--host"}));
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") > 5 || !demo_run->running(); }, 60s));
  ASSERT_TRUE(demo_run->running()) << demo_run->output();
  kill(-demo_run->pid(), SIGINT);  // as a terminal does on Ctrl-C
  EXPECT_EQ(demo_run->wait_for(15s), 130) << demo_run->output();
  EXPECT_TRUE(bus_->wait_until([&] { return all_gone(demo_run->pid()); }, 3s));
}

TEST_F(Demo, RefusesToMixWithAnotherDaemon) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  const Finished second = run(demo(scratch_ / "results", "10", {"--host"}));
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_NE(second.err.find("a planemapd answers already"), std::string::npos) << second.err;
  EXPECT_TRUE(daemon_->running());
}

TEST_F(DemoWithoutRoute, RunsInANamespaceThatIsJoinedToTheMachine) {
  const auto results = scratch_ / "results";
  const auto demo_run = start("demo", demo(results, "15"));
  // What the demo prints for another terminal works, from outside of its namespace.
  const std::string url = "udpm://239.255.76.67:7667?ttl=1";
  int answered = -1;
  while (demo_run->running() && answered != 0) {
    answered = run({program("planemap"), "status", "--lcm-url", url, "--timeout", "1"}).exit_code;
  }
  EXPECT_EQ(answered, 0);
  ASSERT_EQ(demo_run->wait_for(90s), 0) << demo_run->output();
  EXPECT_NE(demo_run->output().find(url), std::string::npos) << demo_run->output();
  expect_results(results, demo_run->output());
  EXPECT_TRUE(all_gone(demo_run->pid()));
}

TEST_F(DemoWithoutRoute, HostWithoutMulticastIsRefusedWithWords) {
  const Finished refused = run(demo(scratch_ / "results", "10", {"--host"}));
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("ip route add 224.0.0.0/4"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace planemap::system_test

#include "harness/system_test.hpp"

#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <system_error>

#include "harness/network.hpp"

namespace planemap::system_test {
namespace {

std::string g_why_no_network;

}  // namespace

std::string program(const std::string& name) {
  return std::string(PLANEMAP_BIN_DIR "/") + name;
}

std::string project_file(const std::string& path) {
  return std::string(PLANEMAP_PROJECT_DIR "/") + path;
}

void UnroutedTest::SetUp() {
  if (!g_why_no_network.empty()) GTEST_SKIP() << g_why_no_network;
}

void SystemTest::SetUp() {
  if (!g_why_no_network.empty()) GTEST_SKIP() << g_why_no_network;
  add_multicast_route();
  routed_ = true;
  bus_ = std::make_unique<Bus>();
}

void SystemTest::TearDown() {
  if (HasFailure()) {
    if (bus_) std::cerr << "Last status: " << bus_->describe();
    if (daemon_) std::cerr << "planemapd said:\n" << daemon_->output();
  }
  daemon_.reset();
  bus_.reset();
  if (routed_) remove_multicast_route();
}

void SystemTest::start_daemon(const std::vector<std::string>& arguments, const std::vector<std::string>& before) {
  std::vector<std::string> command = before;
  const std::vector<std::string> own = {
      program("planemapd"),         "--config", project_file("deploy/planemapd.yaml"), "--lcm-url", kLcmUrl, "--set",
      "publish.status_period_s=0.1"};
  command.insert(command.end(), own.begin(), own.end());
  command.insert(command.end(), arguments.begin(), arguments.end());
  daemon_ = std::make_unique<Process>(command, scratch_ / "planemapd.log");
  const bool heard = bus_->wait_until([this] { return bus_->status().has_value() || !daemon_->running(); }, 20s);
  ASSERT_TRUE(heard && daemon_->running()) << "planemapd did not come up";
}

void SystemTest::stop_daemon() {
  daemon_.reset();
  bus_ = std::make_unique<Bus>();
}

std::unique_ptr<Process> SystemTest::start(const std::string& name, const std::vector<std::string>& arguments) const {
  return std::make_unique<Process>(arguments, scratch_ / (name + ".log"));
}

Finished SystemTest::run(const std::vector<std::string>& arguments, std::chrono::milliseconds limit) const {
  return run_program(arguments, scratch_, limit);
}

std::string SystemTest::recording(const std::string& path) {
  const char* folder = std::getenv("PLANEMAP_TEST_DATA");
  return folder == nullptr ? std::string() : std::string(folder) + "/" + path;
}

}  // namespace planemap::system_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  // Before the first thread: a namespace holds for the threads that are started in it.
  if (!testing::GTEST_FLAG(list_tests))
    planemap::system_test::g_why_no_network = planemap::system_test::enter_own_network();
  return RUN_ALL_TESTS();
}

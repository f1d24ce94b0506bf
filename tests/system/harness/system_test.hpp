#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "harness/bus.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::system_test {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

/// The built program of that name.
std::string program(const std::string& name);
/// A file of the project, for instance "deploy/planemapd.yaml".
std::string project_file(const std::string& path);

/// Tests with real processes on real multicast, in a network namespace of the test's own and with a folder of its own.
/// Skips, visibly, where namespaces are not permitted.
class SystemTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Starts planemapd, ten statuses a second, and waits until it is heard.
  /// @param arguments  beside those
  /// @param before     what runs planemapd, for instance taskset with its arguments
  void start_daemon(const std::vector<std::string>& arguments = {}, const std::vector<std::string>& before = {});

  /// Ends planemapd, and forgets what was heard of it.
  void stop_daemon();

  /// Starts another program; its output goes to <name>.log in the test's folder.
  std::unique_ptr<Process> start(const std::string& name, const std::vector<std::string>& arguments) const;
  /// Runs a program to its end.
  Finished run(const std::vector<std::string>& arguments, std::chrono::milliseconds limit = 30s) const;

  /// A folder or file of the real recordings; empty where PLANEMAP_TEST_DATA does not name any.
  static std::string recording(const std::string& path);

  TemporaryFolder folder_;  ///< first: it outlives the processes that write into it
  const std::filesystem::path scratch_ = folder_.path();
  std::unique_ptr<Bus> bus_;
  std::unique_ptr<Process> daemon_;

 private:
  bool routed_ = false;
};

/// The same without a multicast route: nothing is started yet.
class UnroutedTest : public SystemTest {
 protected:
  void SetUp() override;
};

}  // namespace planemap::system_test

// Runs the built program as a user does.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::cli {
namespace {

namespace fs = std::filesystem;

class CliTest : public testing::Test {
 protected:
  /// Runs "planemap ARGUMENTS"; arguments are the shell's.
  Finished planemap(const std::string& arguments) const {
    return run_in_shell(std::string("'") + PLANEMAP_PROGRAM + "' " + arguments, folder_.path());
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  TemporaryFolder folder_;
};

/// One wall 2 m before the camera, tilted by 0.1 in x, 160x120.
planemap_lcm::depth_scan_t tilted_wall_message(std::int64_t utime) {
  const TestCamera camera{160, 120, 146.0};
  return depth_message(utime, /*seq=*/0, camera, [&](int u, int /*v*/) {
    const double slope = 0.1 * (u - camera.width / 2.0) / camera.focal_px;  // z = 2 m + 0.1 x
    return static_cast<std::uint16_t>(2000.0 / (1.0 - slope) + 0.5);
  });
}

template <class Message>
void write_event(lcm::LogFile& log, const char* channel, std::int64_t utime, const Message& message) {
  Bytes bytes = encoded(message);
  lcm::LogEvent event{};
  event.timestamp = utime;
  event.channel = channel;
  event.datalen = static_cast<int>(bytes.size());
  event.data = bytes.data();
  ASSERT_EQ(log.writeEvent(&event), 0);
}

/// Scans of the wall by a camera at rest, and its poses.
void write_wall_log(const std::string& path, int scans) {
  lcm::LogFile log(path, "w");
  ASSERT_TRUE(log.good());
  for (int k = 0; k < scans; ++k) {
    const std::int64_t utime = 1'000'000 + 33'333 * k;
    write_event(log, "POSE", utime, pose_message(utime));
    write_event(log, "PLANEMAP_SCAN", utime, tilted_wall_message(utime));
  }
}

TEST_F(CliTest, HelpAndVersionAreThereForEveryCommand) {
  for (const char* command : {"", "build", "status", "snapshot", "export", "nearest", "ray", "region", "plane",
                              "floorplan", "watch", "pause", "resume", "reset", "save", "info", "recover"}) {
    const Finished outcome = planemap(std::string(command) + " --help");
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_NE(outcome.out.find("--help"), std::string::npos) << command;
  }
  const Finished version = planemap("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.rfind("planemap ", 0), 0u) << version.out;
}

TEST_F(CliTest, WrongUseIsTwoAndSaysWhatIsWrong) {
  write_wall_log(path("log"), 1);
  const std::string log = "'" + path("log") + "'";
  struct Case {
    std::string arguments;
    std::string said;
  };
  const std::vector<Case> cases = {
      {"", "subcommand"},
      {"fly", "fly"},
      {"build", "INPUT"},
      {"build '" + path("missing") + "'", "missing"},
      {"build " + log + " --export '" + path("map.xyz") + "'", ".svg"},
      {"build " + log + " --export '" + path("nowhere/map.json") + "'", "nowhere"},
      {"build " + log + " --output '" + path("nowhere/a.planemap") + "'", "a.planemap: there is no folder "},
      {"build " + log + " --set grid.cell_sise_m=1", "cell_sise_m"},
      {"build " + log + " --set grid.cell_size_m=wide", "grid.cell_size_m"},
      {"build " + log + " --preset fancy", "fancy"},
      {"build " + log + " --config '" + path("missing.yaml") + "'", "missing.yaml"},
      {"build " + log + " --intrinsics 500,500,320,240", "--intrinsics"},
      {"build '" + folder_.path().string() + "' --intrinsics 500,500", "--intrinsics"},
      {"export - '" + path("map.xyz") + "'", ".csv"},
      {"export map.planemap '" + path("map.csv") + "'", "map.planemap"},
      {"status --timeout 0", "timeout"},
      {"status --server 127.0.0.1:1 --lcm-url memq://", "excludes"},
      {"status --server robot:port", "is no address of a server: it must be HOST, HOST:PORT or [IPv6]:PORT"},
      {"status --token-file " + path("missing"), "--token-file: " + path("missing") + ": cannot be read: No such file"},
      {"status --ca-file " + path("log"), "ca: holds no certificate in PEM"},
      {"status --key-file " + path("log"), "--certificate-file"},
      {"pause --lcm-url memq://", "--lcm-url"},
      {"plane 9223372036854775808", "must be a whole number from 1 to 9223372036854775807, is '9223372036854775808'"},
      {"plane 0", "must be a whole number from 1 to 9223372036854775807, is '0'"},
      {"nearest --point 0 0 0 --epoch 99999999999999999999", "--epoch: must be a whole number from 1 to"},
      {"nearest --point 0 0 0 --seen-since -9223372036854775809", "--seen-since: must be a whole number from -922"},
      {"nearest --point 0 0 0 --count 1001", "--count: must be a whole number from 1 to 1000, is '1001'"},
      {"nearest --point 0 0 0 --max-distance -1", "--max-distance: must be greater than 0 and finite, is -1"},
      {"nearest --point 0 0 0 --sigma -1", "--sigma: must be at least 0 and finite, is -1"},
      {"nearest --point 0 0 0 --sigma 1 --covariance 1 0 0 0 1 0 0 0 1", "--sigma excludes --covariance"},
      {"nearest --point 0 0 -s robot", "--point: '-s' is no number"},
      {"nearest --point nan 0 0", "--point: must be a finite number, is nan"},
      {"ray --from 0 0 0 --direction 0 0 0", "--direction: must not be zero"},
      {"region --box 1 0 0 0 1 1", "--box: the first X must be less than the second, 0; is 1"},
      {"region --sphere 0 0 0 -1", "--sphere: R must be greater than 0, is -1"},
      {"region --cylinder 0 0 0 0 0 1 0", "--cylinder: R must be greater than 0, is 0"},
      {"region --oriented-box 0 0 0 1 1 0 0 1 1 1", "QW QX QY QZ must be a unit quaternion, its length is 1.41421"},
      {"region --frustum 0 0 0 1 0 0 0 180 40 0 1", "HORIZONTAL must be greater than 0 and less than 180, is 180"},
      {"region --frustum 0 0 0 1 0 0 0 60 40 2 1", "NEAR must be at least 0 and less than FAR, 1; is 2"},
      {"watch --changes 1.5", "--changes: must be a whole number from 1 to"},
      {"export - a.json a.json", "a.json: is named more than once"},
  };
  for (const Case& wrong : cases) {
    const Finished outcome = planemap(wrong.arguments);
    EXPECT_EQ(outcome.exit_code, 2) << wrong.arguments;
    EXPECT_NE((outcome.err + outcome.out).find(wrong.said), std::string::npos)
        << wrong.arguments << ": " << outcome.err;
  }
}

TEST_F(CliTest, InputsThatAreNoRecordingsFailWithAReason) {
  std::ofstream(path("text")) << "this is no log";
  const Finished text = planemap("build '" + path("text") + "'");
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_NE(text.err.find("is no LCM event log"), std::string::npos) << text.err;

  fs::create_directory(path("empty"));
  const Finished folder = planemap("build '" + path("empty") + "'");
  EXPECT_EQ(folder.exit_code, 1);
  EXPECT_NE(folder.err.find(path("empty")), std::string::npos) << folder.err;
}

TEST_F(CliTest, ALogWithoutScansFailsAndNamesItsChannels) {
  {
    lcm::LogFile log(path("log"), "w");
    write_event(log, "POSE", 1, pose_message(1));
    write_event(log, "LIDAR", 2, pose_message(1));
  }
  const Finished outcome = planemap("build '" + path("log") + "' --export '" + path("map.json") + "'");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("LIDAR"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(path("map.json")));
}

TEST_F(CliTest, NoDaemonIsThreeWithASentence) {
  for (const std::string command : {"status", "snapshot", "status --json", "export - map.json"}) {
    // A bus of the process's own: there is nobody else on it.
    const Finished outcome = planemap(command + " --lcm-url memq:// --timeout 0.1");
    EXPECT_EQ(outcome.exit_code, 3) << command;
    EXPECT_NE(outcome.err.find("planemapd"), std::string::npos) << outcome.err;
    EXPECT_TRUE(outcome.out.empty()) << outcome.out;
  }
}

TEST_F(CliTest, NoServerIsThreeWithASentence) {
  for (const std::string command : {"status", "snapshot --json", "export - map.json", "watch", "pause", "reset"}) {
    // Port 1 is nobody's here.
    const auto begin = std::chrono::steady_clock::now();
    const Finished outcome = planemap(command + " --server 127.0.0.1:1 --timeout 60");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20)) << command << " waits for nothing";
    EXPECT_EQ(outcome.exit_code, 3) << command;
    EXPECT_NE(outcome.err.find("no planemapd can be reached at 127.0.0.1:1"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("is planemapd running, with grpc.listen there (--server)?"), std::string::npos)
        << outcome.err;
    EXPECT_TRUE(outcome.out.empty()) << outcome.out;
  }
}

TEST_F(CliTest, ATokenFileHoldsOneToken) {
  std::ofstream(path("tokens")) << "read 0123456789abcdef\n";
  const Finished outcome = planemap("status --token-file '" + path("tokens") + "'");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--token-file: " + path("tokens") + ": must hold one token and nothing else"),
            std::string::npos)
      << outcome.err;
}

TEST_F(CliTest, BuildsAWallFromALogTheSameTwice) {
  write_wall_log(path("log"), 8);
  const auto build = [&](const std::string& name) {
    std::string arguments = "build '" + path("log") + "' --json --set 'map.gravity=[0, 1, 0]'";
    for (const char* extension : {".json", ".csv", ".ply", ".svg"})
      arguments += " --export '" + path(name + extension) + "'";
    const Finished outcome = planemap(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  const auto summary = build("first");
  EXPECT_EQ(summary["scans"], 8);
  EXPECT_EQ(summary["points"]["total"], 8 * 160 * 120);
  EXPECT_TRUE(summary["dropped"].empty()) << summary;
  EXPECT_EQ(summary["planes"], 1);
  EXPECT_GT(summary["cells"], 100);
  EXPECT_GT(summary["msPerScan"]["p50"], 0.0);
  EXPECT_GE(summary["msPerScan"]["max"], summary["msPerScan"]["p50"]);
  EXPECT_TRUE(summary["msPerScan"]["stages"].contains("assign"));

  const auto map = nlohmann::json::parse(read_file(path("first.json")));
  ASSERT_EQ(map["planes"].size(), 1u);
  EXPECT_EQ(map["planes"][0]["class"], "wall");
  // z = 2 + 0.1 x, seen from the origin: the normal is (0.1, 0, -1) / |(0.1, 0, -1)|.
  EXPECT_NEAR(map["planes"][0]["normal"][0].get<double>(), 0.1 / std::sqrt(1.01), 1e-3);
  EXPECT_NEAR(map["planes"][0]["normal"][2].get<double>(), -1.0 / std::sqrt(1.01), 1e-3);
  EXPECT_NEAR(map["planes"][0]["d"].get<double>(), 2.0 / std::sqrt(1.01), 2e-3);
  EXPECT_EQ(map["epoch"], summary["epoch"]);

  build("second");
  for (const char* extension : {".json", ".csv", ".ply", ".svg"}) {
    EXPECT_EQ(read_file(path(std::string("first") + extension)), read_file(path(std::string("second") + extension)))
        << extension;
  }
}

TEST_F(CliTest, AMapFileOfABuildExportsWhatTheBuildExports) {
  write_wall_log(path("log"), 8);
  const Finished built = planemap("build '" + path("log") + "' --output '" + path("wall.planemap") + "' --export '" +
                                  path("built.json") + "' --set 'map.gravity=[0, 1, 0]'");
  EXPECT_EQ(built.exit_code, 0) << built.err;
  EXPECT_NE(built.out.find("written: " + path("wall.planemap")), std::string::npos) << built.out;
  const Finished exported = planemap("export '" + path("wall.planemap") + "' '" + path("exported.json") + "'");
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_EQ(read_file(path("exported.json")), read_file(path("built.json")));
}

TEST_F(CliTest, TheEpochNamesInputAndSettings) {
  write_wall_log(path("log"), 2);
  const auto epoch = [&](const std::string& more) {
    const Finished outcome = planemap("build '" + path("log") + "' --json " + more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["epoch"].get<std::uint64_t>();
  };
  const auto first = epoch("");
  EXPECT_EQ(epoch(""), first);
  EXPECT_NE(epoch("--set grid.cell_size_m=0.1"), first);
  EXPECT_NE(epoch("--frames 1"), first);
  EXPECT_LT(first, 1ull << 53u);
  write_wall_log(path("log"), 3);
  EXPECT_NE(epoch(""), first);
}

TEST_F(CliTest, FramesLimitsTheScansOfALog) {
  write_wall_log(path("log"), 6);
  const Finished outcome = planemap("build '" + path("log") + "' --json --frames 4");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["scans"], 4);
}

TEST_F(CliTest, QuietPrintsNothingAndTheSummaryNamesThePlanes) {
  write_wall_log(path("log"), 8);
  const Finished quiet = planemap("build '" + path("log") + "' --quiet");
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  const Finished summary = planemap("build '" + path("log") + "'");
  EXPECT_EQ(summary.exit_code, 0);
  EXPECT_NE(summary.out.find("scans mapped: 8"), std::string::npos) << summary.out;
  EXPECT_NE(summary.out.find("ms per scan"), std::string::npos);
  EXPECT_NE(summary.out.find("planes: 1"), std::string::npos);
  EXPECT_EQ(summary.err, "") << "no progress where stderr is no terminal";
}

TEST_F(CliTest, OutputThatIsLostIsAFailure) {
  write_wall_log(path("log"), 2);
  for (const char* how : {"--json", ""}) {
    const Finished outcome = planemap("build '" + path("log") + "' " + how + " > /dev/full");
    EXPECT_EQ(outcome.exit_code, 1) << how;
    EXPECT_NE(outcome.err.find("could not be written"), std::string::npos) << outcome.err;
  }
}

TEST_F(CliTest, SettingsOfMessagesAreSaidNotToApplyToAFolder) {
  const char* data = std::getenv("PLANEMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set";
  const std::string build = std::string("build '") + data + "/redkitchen' --frames 1 --json ";
  const Finished plain = planemap(build + "--set pose.sigma_m=0.001");
  EXPECT_EQ(plain.exit_code, 0);
  EXPECT_EQ(plain.err, "");
  const Finished told = planemap(build + "--set inputs.0.max_range_m=1.5");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_NE(told.err.find("inputs.* and pose.* are about messages"), std::string::npos) << told.err;
}

TEST_F(CliTest, TheRedKitchenBuildsTheSameTwice) {
  const char* data = std::getenv("PLANEMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set";
  const std::string build = std::string("build '") + data + "/redkitchen' --frames 12 --json --export '";
  const Finished first = planemap(build + path("first.json") + "'");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  ASSERT_EQ(planemap(build + path("second.json") + "'").exit_code, 0);
  EXPECT_EQ(read_file(path("first.json")), read_file(path("second.json")));
  const auto summary = nlohmann::json::parse(first.out);
  EXPECT_EQ(summary["scans"], 12);
  EXPECT_EQ(summary["points"]["total"], 12 * 640 * 480);
  EXPECT_GT(summary["planes"], 3);
  const auto map = nlohmann::json::parse(read_file(path("first.json")));
  const auto has_class = [](const auto& plane) { return plane["class"] != "other"; };
  EXPECT_TRUE(std::any_of(map["planes"].begin(), map["planes"].end(), has_class))
      << "the folder's gravity was not taken";
}

}  // namespace
}  // namespace planemap::cli

// Runs the built program as a user does.
#include <gtest/gtest.h>
#include <zlib.h>

#include <bot_core/pose_t.hpp>
#include <cstdlib>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <planemap_lcm/depth_scan_t.hpp>
#include <string>
#include <vector>

#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::kinect_bridge {
namespace {

class KinectBridge : public testing::Test {
 protected:
  /// Runs "planemap-kinect-bridge ARGUMENTS"; arguments are the shell's.
  Finished bridge(const std::string& arguments) const {
    return run_in_shell(std::string("'") + KINECT_BRIDGE_PROGRAM + "' " + arguments, folder_.path());
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  TemporaryFolder folder_;
};

struct Recorded {
  std::vector<planemap_lcm::depth_scan_t> scans;
  std::vector<bot_core::pose_t> poses;
};

Recorded read_log(const std::string& path) {
  Recorded recorded;
  lcm::LogFile log(path, "r");
  EXPECT_TRUE(log.good());
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    std::int64_t utime = 0;
    if (event->channel == "POSE") {
      bot_core::pose_t pose{};
      EXPECT_EQ(pose.decode(event->data, 0, event->datalen), event->datalen);
      utime = pose.utime;
      recorded.poses.push_back(pose);
    } else {
      EXPECT_EQ(event->channel, "PLANEMAP_SCAN");
      planemap_lcm::depth_scan_t scan{};
      EXPECT_EQ(scan.decode(event->data, 0, event->datalen), event->datalen);
      utime = scan.utime;
      const auto crc = crc32(0, scan.data.data(), static_cast<uInt>(scan.data.size()));
      EXPECT_EQ(static_cast<std::uint32_t>(scan.crc32), crc);
      recorded.scans.push_back(scan);
    }
    EXPECT_EQ(event->timestamp, utime) << "event times are the messages'";
  }
  return recorded;
}

TEST_F(KinectBridge, HelpAndVersionAreThere) {
  const Finished help = bridge("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* option :
       {"--dataset", "--simulate", "--seed", "--truth", "--log", "--pose-rate", "Exit codes", "--format",
        "image_array_float", "drake.lcmt_point_cloud", "--pose-format", "apartment", "door-ajar", "ceiling-glimpse"}) {
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
  }
  const Finished version = bridge("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.rfind("planemap-kinect-bridge ", 0), 0u) << version.out;
}

TEST_F(KinectBridge, WrongUseIsTwoAndSaysWhatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "--dataset"},
      {"--simulate apartment --dataset x", "--simulate"},
      {"--simulate castle", "castle"},
      {"--simulate apartment --frames 0", "--frames"},
      {"--simulate apartment --rate -3", "--rate"},
      {"--simulate apartment --noise nothing", "--noise"},
      {"--simulate apartment --intrinsics 1,2,3,4", "--dataset"},
      {"--dataset x --seed 3", "--simulate"},
      {"--dataset x --intrinsics 1,2,3", "fx,fy,cx,cy"},
      {"--dataset x --log y --lcm-url z", "--lcm-url"},
      {"--dataset x --log y --rate 5", "recorded"},
      {"--simulate apartment --log y --loop", "--frames"},
      {"--simulate apartment --channel ''", "channel"},
      {"--simulate apartment --channel POSE", "must be another one than the scans'"},
      {"--simulate apartment --encoding jpeg", "zlib"},
      {"--simulate apartment --encoding png", "depth_scan knows no png"},
      {"--simulate apartment --format image --encoding zlib", "image knows no zlib"},
      {"--simulate apartment --format laser", "kinect_disparity"},
      {"--simulate apartment --pose-format euler", "rigid_transform"},
      {"--simulate apartment --nonsense", "--nonsense"}};
  for (const auto& wrong : cases) {
    const Finished outcome = bridge(wrong.first);
    EXPECT_EQ(outcome.exit_code, 2) << wrong.first << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(wrong.second), std::string::npos) << wrong.first << "\n" << outcome.err;
  }
}

TEST_F(KinectBridge, SaysWhatPlanemapdMustBeToldOfAFormat) {
  const Finished quiet = bridge("--simulate apartment --frames 2 --log '" + path("own") + "'");
  EXPECT_EQ(quiet.err.find("such scans need"), std::string::npos) << quiet.err;
  const Finished said =
      bridge("--simulate apartment --frames 2 --format kinect_disparity --log '" + path("other") + "'");
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_NE(said.err.find("such scans need: planemapd --set 'inputs.0.intrinsics=[585, 585, 320, 240]' --set "
                          "'inputs.0.disparity=[0.075, 1090]'"),
            std::string::npos)
      << said.err;
  const Finished of_many = bridge("--simulate apartment --frames 2 --format image_array --log '" + path("array") + "'");
  EXPECT_EQ(of_many.exit_code, 0);
  EXPECT_NE(of_many.err.find("such scans need: planemapd --set 'inputs.0.intrinsics=[585, 585, 320, 240]' --set "
                             "'inputs.0.frame=kinect'"),
            std::string::npos)
      << of_many.err;
}

TEST_F(KinectBridge, FailuresAreOneAndSayWhatToDo) {
  const Finished missing = bridge("--dataset '" + path("missing") + "' --log '" + path("log") + "'");
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("no such folder"), std::string::npos) << missing.err;
  const Finished unwritable = bridge("--simulate apartment --frames 2 --log '" + path("no/log") + "'");
  EXPECT_EQ(unwritable.exit_code, 1);
  EXPECT_NE(unwritable.err.find(path("no/log")), std::string::npos) << unwritable.err;
  const Finished bad_url = bridge("--simulate apartment --frames 2 --lcm-url nonsense://x");
  EXPECT_EQ(bad_url.exit_code, 1);
  EXPECT_NE(bad_url.err.find("nonsense://x"), std::string::npos) << bad_url.err;
}

TEST_F(KinectBridge, LogOfASimulationHoldsItsFramesAndTheTruthItsPlanes) {
  const Finished outcome = bridge("--simulate apartment --seed 5 --frames 6 --rate 10 --pose-rate 100 --json --log '" +
                                  path("log") + "' --truth '" + path("truth.json") + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary.at("frames"), 6);
  EXPECT_EQ(summary.at("lastUtime"), 1'500'000);
  EXPECT_EQ(summary.at("log"), path("log"));
  const Recorded recorded = read_log(path("log"));
  ASSERT_EQ(recorded.scans.size(), 6u);
  EXPECT_EQ(recorded.poses.size(), 6u + 5u * 9u);
  EXPECT_EQ(summary.at("poses"), recorded.poses.size());
  for (std::size_t k = 0; k < recorded.scans.size(); ++k) {
    EXPECT_EQ(recorded.scans[k].seq, static_cast<std::int32_t>(k));
    EXPECT_EQ(recorded.scans[k].utime, static_cast<std::int64_t>(1'000'000 + 100'000 * k));
    EXPECT_EQ(recorded.scans[k].width, 640);
    EXPECT_EQ(recorded.scans[k].encoding, planemap_lcm::depth_scan_t::ENCODING_ZLIB);
  }
  EXPECT_GT(nlohmann::json::parse(read_file(path("truth.json"))).at("planes").size(), 30u);
}

TEST_F(KinectBridge, SpecialRoomsAreRenderedByName) {
  const Finished outcome = bridge("--simulate ceiling-glimpse --json --quiet --log '" + path("log") + "' --truth '" +
                                  path("truth.json") + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out).at("frames"), 28) << "the room's own number";
  const auto truth = nlohmann::json::parse(read_file(path("truth.json")));
  ASSERT_EQ(truth.at("planes").size(), 6u);
  EXPECT_EQ(truth.at("planes")[1].at("name"), "ceiling");
}

TEST_F(KinectBridge, TruthOfTheBuildingIsWhatWasSeenOfIt) {
  const auto planes = [this](const std::string& frames) {
    const Finished done = bridge("--simulate building --time-lapse 15 --frames " + frames + " -q --log " +
                                 path("building.lcm") + " --truth " + path("truth.json"));
    EXPECT_EQ(done.exit_code, 0) << done.err;
    std::ifstream file(path("truth.json"));
    return nlohmann::json::parse(file).at("planes").size();
  };
  const std::size_t few = planes("2");
  EXPECT_GT(few, 2u);
  EXPECT_GT(planes("40"), few + 5);
}

TEST_F(KinectBridge, SameSeedGivesTheSameLog) {
  for (const char* name : {"a", "b"}) {
    const std::string noise = " --pose-noise-m 0.01 --pose-noise-deg 0.5 --pose-correlation-s 2";
    ASSERT_EQ(bridge("--simulate apartment --seed 11 --frames 3 --quiet --log '" + path(name) + "'" + noise).exit_code,
              0);
  }
  EXPECT_FALSE(read_file(path("a")).empty());
  EXPECT_EQ(read_file(path("a")), read_file(path("b")));
}

TEST_F(KinectBridge, LogOfALoopedDatasetKeepsItsTimes) {
  const char* folder = std::getenv("PLANEMAP_TEST_DATA");
  if (folder == nullptr) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set: no real data here";
  const Finished outcome = bridge("--dataset '" + std::string(folder) +
                                  "/tum_fr1_desk_9' --loop --frames 12 --json --log '" + path("log") + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Recorded recorded = read_log(path("log"));
  ASSERT_EQ(recorded.scans.size(), 12u);
  EXPECT_EQ(recorded.scans.front().utime, 1305031453374112);
  EXPECT_DOUBLE_EQ(recorded.scans.front().depth_scale_m, 1.0 / 5000.0);
  for (std::size_t k = 1; k < recorded.scans.size(); ++k) {
    EXPECT_GT(recorded.scans[k].utime, recorded.scans[k - 1].utime);
  }
  EXPECT_EQ(recorded.scans[0].data, recorded.scans[9].data) << "the tenth frame is the first again";
  EXPECT_EQ(nlohmann::json::parse(outcome.out).at("skipped").at("depth image missing"), 586);
}

}  // namespace
}  // namespace planemap::kinect_bridge

// Scans and poses in the types of other stacks: the planes are those of our own types, and Drake's viewer gets them.
#include <algorithm>
#include <cmath>
#include <drake/lcmt_point_cloud.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/network.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

using nlohmann::json;

class FieldFormats : public SystemTest {
 protected:
  /// A drive of the simulated Kinect as a log, in other types. @return the bridge's summary
  json write_log(const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> command = {program("planemap-kinect-bridge"),
                                        "--simulate",
                                        "apartment",
                                        "--seed",
                                        "5",
                                        "--frames",
                                        "12",
                                        "--quiet",
                                        "--json",
                                        "--log",
                                        log_of(name)};
    command.insert(command.end(), options.begin(), options.end());
    const Finished bridge = run(command, 120s);
    EXPECT_EQ(bridge.exit_code, 0) << bridge.err;
    return json::parse(bridge.out, nullptr, /*allow_exceptions=*/false);
  }

  /// The planes of a log.
  json planes_of(const std::string& name, const std::vector<std::string>& settings) {
    const std::string path = (scratch_ / (name + ".json")).string();
    std::vector<std::string> command = {program("planemap"), "build", log_of(name), "--export", path};
    for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
    const Finished built = run(command, 120s);
    EXPECT_EQ(built.exit_code, 0) << built.err << built.out;
    return json::parse(read_file(path), nullptr, /*allow_exceptions=*/false).at("planes");
  }

  std::string log_of(const std::string& name) const { return (scratch_ / (name + ".lcmlog")).string(); }

  /// The setting for the intrinsics that the bridge says, the size behind them.
  static std::string intrinsics(const json& summary) {
    return "inputs.0.intrinsics=" + summary.at("intrinsics").dump();
  }
};

/// Every plane of `expected` that is large has one in `planes` at the same place.
void expect_alike(const json& expected, const json& planes, double within_m, double within_rad) {
  int large = 0;
  for (const json& plane : expected) {
    if (plane.at("area").get<double>() < 1.5) continue;
    ++large;
    const auto n = plane.at("normal").get<std::vector<double>>();
    const auto c = plane.at("centroid").get<std::vector<double>>();
    const bool found = std::any_of(planes.begin(), planes.end(), [&](const json& other) {
      const auto m = other.at("normal").get<std::vector<double>>();
      const double cosine = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
      const double distance = m[0] * c[0] + m[1] * c[1] + m[2] * c[2] + other.at("d").get<double>();
      return std::acos(std::min(1.0, cosine)) < within_rad && std::abs(distance) < within_m;
    });
    EXPECT_TRUE(found) << plane.dump().substr(0, 300);
  }
  EXPECT_GE(large, 4);
}

TEST_F(FieldFormats, TheSameIntegersGiveTheSamePlanes) {
  write_log("own", {});
  const json own = planes_of("own", {});
  ASSERT_GE(own.size(), 8u);
  const struct {
    const char* name;
    std::vector<std::string> options;
    std::vector<std::string> settings;
  } cases[] = {
      {"kinect_frame", {"--format", "kinect_frame"}, {"inputs.0.family=kinect_frame"}},
      {"kinect_raw", {"--format", "kinect_frame", "--encoding", "raw"}, {}},
      {"images", {"--format", "images"}, {}},
      {"images_raw", {"--format", "images", "--encoding", "raw", "--pose-format", "rigid_transform"}, {}},
      {"image", {"--format", "image"}, {}},
      {"array", {"--format", "image_array"}, {"inputs.0.frame=kinect"}},
      {"array_raw", {"--format", "image_array", "--encoding", "raw"}, {}},
      {"array_png", {"--format", "image_array", "--encoding", "png"}, {}},
      {"array_float", {"--format", "image_array_float"}, {}},
      {"array_float_raw", {"--format", "image_array_float", "--encoding", "raw", "--pose-format", "pose_cov"}, {}},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    const json summary = write_log(c.name, c.options);
    std::vector<std::string> settings = c.settings;
    settings.push_back(intrinsics(summary));
    EXPECT_EQ(planes_of(c.name, settings), own);
    std::filesystem::remove(log_of(c.name));
  }
}

TEST_F(FieldFormats, CloudsAndDisparitiesGivePlanesAtTheSamePlaces) {
  write_log("own", {});
  const json own = planes_of("own", {});
  const json summary = write_log("disparity", {"--format", "kinect_disparity"});
  // A step of disparity is 2 cm at 3 m.
  expect_alike(own, planes_of("disparity", {intrinsics(summary), "inputs.0.disparity=[0.075, 1090]"}), 0.03, 0.03);
  write_log("cloud2", {"--format", "pointcloud2"});
  const json cloud2 = planes_of("cloud2", {});
  expect_alike(own, cloud2, 0.01, 0.01);
  write_log("cloud", {"--format", "point_cloud"});
  // The points that saw nothing make no difference but for the order in which sums are taken.
  const json cloud = planes_of("cloud", {});
  EXPECT_EQ(cloud.size(), cloud2.size());
  expect_alike(cloud2, cloud, 1e-5, 1e-5);
}

TEST_F(FieldFormats, WithoutIntrinsicsNothingIsMappedAndTheReasonIsSaid) {
  write_log("images", {"--format", "images"});
  const Finished built =
      run({program("planemap"), "build", log_of("images"), "--export", (scratch_ / "planes.json").string()}, 60s);
  EXPECT_NE((built.err + built.out).find("images_t brings no intrinsics: set inputs[].intrinsics to [fx, fy, cx, cy]"),
            std::string::npos)
      << built.err << built.out;
}

/// Clouds of planes, as a viewer hears them.
struct HeardClouds {
  int count = 0;
  drake::lcmt_point_cloud last{};
  void on_cloud(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                const drake::lcmt_point_cloud* cloud) {
    ++count;
    last = *cloud;
  }
};

TEST_F(FieldFormats, TwoSensorsOfOtherStacksAtOnceAndDrakesViewerSeesThePlanes) {
  // Two sensors on the same tour of one apartment, each with poses of its own.
  ASSERT_NO_FATAL_FAILURE(start_daemon(
      {"--set",
       "inputs.0={name: head, channel: OPENNI_FRAME, intrinsics: [585, 585, 320, 240], pose_channel: POSE_BODY}",
       "--set",
       "inputs.1={name: arm, channel: DRAKE_RGBD_CAMERA_IMAGES, frame: kinect, intrinsics: [585, 585, 320, 240], "
       "pose_channel: CAMERA_TO_LOCAL}",
       "--set", "publish.point_cloud_channel=DRAKE_POINT_CLOUD_PLANEMAP", "--set",
       "publish.point_cloud_period_s=0.2"}));
  HeardClouds heard;
  bus_->lcm().subscribe("DRAKE_POINT_CLOUD_PLANEMAP", &HeardClouds::on_cloud, &heard);
  const auto bridge = [this](const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> command = {program("planemap-kinect-bridge"),
                                        "--simulate",
                                        "apartment",
                                        "--seed",
                                        "5",
                                        "--frames",
                                        "20",
                                        "--rate",
                                        "5",
                                        "--quiet",
                                        "--lcm-url",
                                        kLcmUrl};
    command.insert(command.end(), options.begin(), options.end());
    return start(name, command);
  };
  const auto head = bridge("head", {"--format", "images", "--channel", "OPENNI_FRAME", "--pose-channel", "POSE_BODY"});
  const auto arm = bridge("arm", {"--format", "image_array", "--channel", "DRAKE_RGBD_CAMERA_IMAGES", "--pose-channel",
                                  "CAMERA_TO_LOCAL", "--pose-format", "rigid_transform"});
  const bool mapped = bus_->wait_until([&] { return bus_->counter("scans.mapped") >= 40; }, 90s);
  EXPECT_TRUE(mapped) << head->output() << arm->output();
  EXPECT_EQ(bus_->counters_beginning("scans.rejected."), 0);
  EXPECT_EQ(bus_->counters_beginning("poses.rejected."), 0);
  const int before = heard.count;
  EXPECT_TRUE(bus_->wait_until([&] { return heard.count > before + 1; }, 20s));  // goes on where nothing changes
  EXPECT_EQ(heard.last.frame_name, "world");
  EXPECT_EQ(heard.last.num_fields, 4);
  EXPECT_GT(heard.last.width, 1000);
  EXPECT_LE(heard.last.width, 4000);
  EXPECT_GE(bus_->status()->plane_count, 8);
}

}  // namespace
}  // namespace planemap::system_test

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "config/service_config.hpp"

namespace planemap::service {
namespace {

/// A file of this test's own, gone after it.
class ConfigFile {
 public:
  explicit ConfigFile(const std::string& text) {
    std::string name = (std::filesystem::temp_directory_path() / "planemap_config_XXXXXX").string();
    const int descriptor = mkstemp(name.data());
    if (descriptor >= 0) close(descriptor);
    path_ = name;
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~ConfigFile() { std::filesystem::remove(path_); }
  ConfigFile(const ConfigFile&) = delete;
  ConfigFile& operator=(const ConfigFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

Expected<ServiceConfig> load_text(const std::string& text) {
  const ConfigFile file(text);
  return load_config({"best", file.path(), {}});
}
Expected<ServiceConfig> load_overrides(std::vector<std::string> overrides) {
  return load_config({"best", "", std::move(overrides)});
}
std::string defaults_yaml() {
  return to_yaml(load_overrides({}).value());
}
/// The problems of a text, without the file's name in front of each line.
std::string problems_of(const std::string& text) {
  const ConfigFile file(text);
  const auto config = load_config({"best", file.path(), {}});
  if (config) return "no problem";
  std::string problems = config.error().message;
  for (auto at = problems.find(file.path()); at != std::string::npos; at = problems.find(file.path())) {
    problems.replace(at, file.path().size(), "F");
  }
  return problems;
}

TEST(Config, DefaultsArePresetBest) {
  const auto config = load_overrides({});
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->mapper.grid.cell_size_m, preset(Preset::kBest).grid.cell_size_m);
  ASSERT_EQ(config->inputs.size(), 1u);
  EXPECT_EQ(config->inputs[0].channel, "PLANEMAP_SCAN");
  EXPECT_EQ(config->publish.page_bytes, 60000);
}

TEST(Config, PresetPaperDiffersFromBest) {
  const auto paper = load_config({"paper", "", {}});
  ASSERT_TRUE(paper);
  EXPECT_NE(to_yaml(*paper), defaults_yaml());
  const auto unknown = load_config({"worst", "", {}});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().message, "--preset: 'worst' is not known (allowed: best, paper)");
}

TEST(Config, ShippedFileIsTheDefault) {
  const auto config = load_config({"best", PLANEMAP_SOURCE_DIR "/deploy/planemapd.yaml", {}});
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(to_yaml(*config), defaults_yaml());
}

TEST(Config, PrintedTextReadsBackToTheSame) {
  auto config = load_overrides(
      {"grid.cell_size_m=0.0625", "normals.fit=centres", "planes.adoption=false", "map.gravity=[0.1, -0.2, -0.97]",
       "map.frame=\"a \\\"quoted\\\" name\"", "inputs.0.rotation_wxyz=[0.5, -0.5, 0.5, -0.5]",
       "inputs.0.body_mask=[{min_m: [-0.3, -0.2, 0], max_m: [0.3, 0.2, 0.5]}]", "inputs.1.name=second",
       "inputs.1.channel=SCAN_2", "inputs.1.max_rate_hz=7.5", "log.format=json"});
  ASSERT_TRUE(config) << config.error().message;
  const std::string text = to_yaml(*config);
  const auto again = load_text(text);
  ASSERT_TRUE(again) << again.error().message << "\n" << text;
  EXPECT_EQ(to_yaml(*again), text);
  ASSERT_EQ(again->inputs.size(), 2u);
  EXPECT_EQ(again->map.frame, "a \"quoted\" name");
  EXPECT_EQ(again->inputs[0].body_mask.at(0).max_m, (std::vector<double>{0.3, 0.2, 0.5}));
  EXPECT_EQ(again->mapper.normals.fit, NormalFit::kCentres);
  EXPECT_EQ(again->inputs[1].max_rate_hz, 7.5);
}

TEST(Config, EveryKeyIsPrintedWithItsHelp) {
  const std::string text = defaults_yaml();
  std::size_t keys = 0;
  ServiceConfig config;
  visit_sections(config, [&](const SectionInfo& section, auto& fields) {
    EXPECT_NE(text.find(std::string("\n") + section.key + ":"), std::string::npos) << section.key;
    if constexpr (!std::is_same_v<std::decay_t<decltype(fields)>, std::vector<InputConfig>>) {
      visit_fields(fields, [&](const FieldInfo& info, auto&, const auto&...) {
        ++keys;
        EXPECT_NE(text.find(std::string("  ") + info.key + ": "), std::string::npos) << info.key;
        EXPECT_NE(text.find(info.help), std::string::npos) << info.key;
      });
    }
  });
  EXPECT_GT(keys, 40u);
}

TEST(Config, FileThenOverridesWin) {
  const ConfigFile file("grid:\n  cell_size_m: 0.05\nqueue:\n  scans: 9\n");
  const auto config = load_config({"best", file.path(), {"grid.cell_size_m=0.04"}});
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->mapper.grid.cell_size_m, 0.04);
  EXPECT_EQ(config->queue.scans, 9);
}

TEST(Config, EmptyFileIsTheDefault) {
  for (const char* text : {"", "# nothing but a comment\n", "---\n", "grid:\n  # cell_size_m: 1\npose:\n"}) {
    const auto config = load_text(text);
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_EQ(to_yaml(*config), defaults_yaml());
  }
}

TEST(Config, EveryProblemIsListedWithItsLine) {
  EXPECT_EQ(problems_of("grid:\n"
                        "  cell_size: 0.08\n"
                        "  density_threshold: 12.5\n"
                        "queue:\n"
                        "  scans: 0\n"
                        "gird:\n"
                        "  cell_size_m: 1\n"),
            "F:3: grid.density_threshold: '12.5' is not a whole number (allowed: 0 to 1000000000)\n"
            "F:2: grid.cell_size: unknown key; did you mean cell_size_m?\n"
            "F:5: queue.scans: 0 is out of range (allowed: 1 to 1000)\n"
            "F:6: gird: unknown key; did you mean grid?");
}

struct BadText {
  const char* text;
  const char* problem;
};

TEST(Config, SaysWhatIsWrongWithEachKindOfValue) {
  const BadText cases[] = {
      {"grid: 3\n", "F:1: grid: must be keys with values, not '3'"},
      {"- grid\n", "F:1: configuration: must be keys with values, not a list"},
      {"grid:\n  cell_size_m: wide\n", "F:2: grid.cell_size_m: 'wide' is not a number (allowed: 0.005 to 10)"},
      {"grid:\n  cell_size_m: \"0.1\"\n", "F:2: grid.cell_size_m: '0.1' is not a number (allowed: 0.005 to 10)"},
      {"grid:\n  cell_size_m: .nan\n", "F:2: grid.cell_size_m: '.nan' is not a number (allowed: 0.005 to 10)"},
      {"grid:\n  cell_size_m: nan\n", "F:2: grid.cell_size_m: nan is out of range (allowed: 0.005 to 10)"},
      {"grid:\n  cell_size_m: [1]\n", "F:2: grid.cell_size_m: must be a number, not a list"},
      {"grid:\n  cell_size_m:\n", "F:2: grid.cell_size_m: has no value"},
      {"grid:\n  clamp_centres: yes\n", "F:2: grid.clamp_centres: 'yes' is not a truth value (allowed: true, false)"},
      {"normals:\n  fit: best\n", "F:2: normals.fit: 'best' is not known (allowed: centres, pooled)"},
      {"log:\n  level: loud\n", "F:2: log.level: 'loud' is not known (allowed: trace, debug, info, warn, error)"},
      {"grid:\n  cell_size_m: 0.1\n  cell_size_m: 0.2\n", "F:3: grid.cell_size_m: given twice"},
      {"map:\n  gravity: down\n", "F:2: map.gravity: must be a list of numbers, for instance [0, 0, 1]"},
      {"map:\n  gravity: [0, 0]\n", "F:2: map.gravity: has 2 numbers, must have 3, or none"},
      {"map:\n  gravity: [0, 0, 0]\n", "F:2: map.gravity: is zero; leave it empty where the direction is not known"},
      {"map:\n  gravity: [0, 0, x]\n", "F:2: map.gravity.2: 'x' is not a number (allowed: -1000000000 to 1000000000)"},
      {"inputs: []\n", "F:1: inputs: has 0 entries (allowed: 1 to 64)"},
      {"inputs: 4\n", "F:1: inputs: must be a list"},
      {"inputs:\n  - channel: \"\"\n", "F:2: inputs.0.channel: has 0 characters (allowed: 1 to 63)"},
      {"inputs:\n  - channel: A B\n", "F:2: inputs.0.channel: a channel's name must be printable ASCII without spaces"},
      {"inputs:\n  - rotation_wxyz: [1, 0, 0, 0.1]\n",
       "F:2: inputs.0.rotation_wxyz: is no unit quaternion: its length is 1.00499 (allowed: 1 within 0.001)"},
      {"inputs:\n  - translation_m: [1, 0]\n", "F:2: inputs.0.translation_m: has 2 numbers, must have 3"},
      {"inputs:\n  - min_range_m: 3\n    max_range_m: 2\n",
       "F:2: inputs.0.min_range_m: 3 must be less than max_range_m (2)"},
      {"inputs:\n  - body_mask:\n    - min_m: [0, 0, 0]\n",
       "F:3: inputs.0.body_mask.0: needs min_m and max_m, three numbers each"},
      {"inputs:\n  - body_mask: [{min_m: [0, 1, 0], max_m: [1, 1, 1]}]\n",
       "F:2: inputs.0.body_mask.0: min_m must be less than max_m along y"},
      {"inputs:\n  - channel: POSE\n", "inputs.0.pose_channel: 'POSE' is used by inputs.0.channel, too"},
      {"inputs:\n  - name: a\n  - name: b\n", "inputs.1.channel: 'PLANEMAP_SCAN' is used by inputs.0.channel, too"},
      {"inputs:\n  - channel: A\n  - channel: B\n", "F:3: inputs.1.name: 'kinect' is the name of inputs.0, too"},
      {"publish:\n  delta_channel: POSE\n", "F:2: publish.delta_channel: 'POSE' is used by inputs.0.pose_channel, too"},
      {"sensor:\n  min_range_m: 6\n", "F:2: sensor.min_range_m: 6 must be less than max_range_m (5)"},
      {"pose:\n  buffer_s: 0.5\n", "F:2: pose.buffer_s: 0.5 must be at least max_gap_s + max_wait_s (1)"},
      {"pose:\n  restart_s: 20\n", "F:2: pose.restart_s: 20 must be at most buffer_s (10)"},
      {"pose:\n  jump: stop\n", "F:2: pose.jump: 'stop' is not known (allowed: continue, reset)"},
      {"pose:\n  exact_s: 0.7\n", "F:2: pose.exact_s: 0.7 must be at most max_gap_s (0.5)"},
      {"a: 1\n---\nb: 2\n", "F: configuration: more than one YAML document"},
  };
  for (const auto& c : cases) {
    const std::string problems = problems_of(c.text);
    EXPECT_NE(problems.find(c.problem), std::string::npos) << c.text << "gave\n" << problems << "\nnot\n" << c.problem;
  }
}

TEST(Config, AStrayCommaEnds) {  // yaml-cpp's LoadAll() never does
  for (const std::string& text : {std::string("\0\0\0,\0", 5), std::string(","), std::string("a: 1\n,\n")}) {
    (void)problems_of(text);
  }
}

TEST(Config, BrokenYamlIsAProblemNotACrash) {
  std::string deep(100000, '[');
  for (const std::string& text :
       {std::string("grid: {cell_size_m: 0.1\n"), std::string("\t- x: [\n"), deep, std::string("a: &a [*a]\n"),
        std::string("\0\xff\xfe", 3), std::string("? [x, y]\n: 1\n")}) {
    const auto config = load_text(text);
    ASSERT_FALSE(config);
    EXPECT_FALSE(config.error().message.empty());
  }
}

TEST(Config, FileProblemsNameTheFile) {
  const auto missing = load_config({"best", "/nonexistent/planemapd.yaml", {}});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().message, "/nonexistent/planemapd.yaml: cannot be read: No such file or directory");
  const auto huge = load_text(std::string(2 << 20, '#'));
  ASSERT_FALSE(huge);
  EXPECT_NE(huge.error().message.find("is larger than 1048576 bytes"), std::string::npos);
  const auto folder = load_config({"best", "/", {}});
  ASSERT_FALSE(folder);
}

TEST(Config, OverrideProblemsNameTheOverride) {
  const BadText cases[] = {
      {"grid.cell_size_m=9000",
       "--set grid.cell_size_m=9000: grid.cell_size_m: 9000 is out of range (allowed: 0.005 to 10)"},
      {"grid.cellsize=1", "--set grid.cellsize=1: grid.cellsize: unknown key; did you mean cell_size_m?"},
      {"inputs.2.channel=X", "--set inputs.2.channel=X: inputs.2: no such entry (allowed: 0 to 1)"},
      {"inputs.x.channel=X", "--set inputs.x.channel=X: inputs.x: no such entry (allowed: 0 to 1)"},
      {"cell_size_m=1", "--set cell_size_m=1: override: must be section.key=value, for instance grid.cell_size_m=0.05"},
      {"grid.cell_size_m",
       "--set grid.cell_size_m: override: must be section.key=value, for instance grid.cell_size_m=0.05"},
      {"map.gravity=[0, 0", "--set map.gravity=[0, 0: YAML:"},
  };
  for (const auto& c : cases) {
    const auto config = load_overrides({c.text});
    ASSERT_FALSE(config) << c.text;
    EXPECT_NE(config.error().message.find(c.problem), std::string::npos) << config.error().message << "\nnot\n"
                                                                         << c.problem;
  }
}

TEST(Config, UnitVectorsAreNormalised) {
  const auto config = load_overrides({"map.gravity=[0, 0, -9.81]", "inputs.0.rotation_wxyz=[0.7071, 0, 0.7071, 0]"});
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_DOUBLE_EQ(config->map.gravity[2], -1.0);
  EXPECT_NEAR(config->inputs[0].rotation_wxyz[0], std::sqrt(0.5), 1e-15);
}

TEST(Config, WhatTheGrpcServerCannotDoIsRefused) {
  const struct {
    std::vector<std::string> overrides;
    const char* problem;
  } cases[] = {
      {{"grpc.listen=0.0.0.0:7670"},
       "--set grpc.listen=0.0.0.0:7670: grpc.listen: 0.0.0.0:7670 can be reached from other machines: it needs "
       "grpc.tls_certificate and grpc.tls_key (or listen on 127.0.0.1)"},
      {{"grpc.listen=robot.example.org:1"}, "robot.example.org:1 can be reached from other machines"},
      {{"grpc.listen=127.0.0.1"},
       "grpc.listen: '127.0.0.1' is no HOST:PORT: it has no port (for instance 127.0.0.1:7670 or [::1]:7670)"},
      {{"grpc.listen=127.0.0.1:70000"}, "the port must be a number from 0 to 65535"},
      {{"grpc.listen='::1:7670'"}, "an IPv6 number needs brackets"},
      {{"grpc.listen=':7670'"}, "it has no host"},
      {{"grpc.tls_key=k"}, "grpc.tls_certificate: is missing: certificate and key go together"},
      {{"grpc.tls_certificate=c"}, "grpc.tls_key: is missing: certificate and key go together"},
      {{"grpc.tls_client_ca=c"},
       "grpc.tls_client_ca: needs grpc.tls_certificate and grpc.tls_key: without TLS nobody shows one"},
      {{"grpc.max_connections=0"}, "grpc.max_connections: 0 is out of range (allowed: 1 to 10000)"},
  };
  for (const auto& c : cases) {
    const auto config = load_overrides(c.overrides);
    ASSERT_FALSE(config) << c.overrides[0];
    EXPECT_NE(config.error().message.find(c.problem), std::string::npos) << config.error().message << "\nnot\n"
                                                                         << c.problem;
  }
  for (const char* listen : {"grpc.listen=", "grpc.listen='[::1]:0'", "grpc.listen=localhost:7670"}) {
    EXPECT_TRUE(load_overrides({listen})) << listen;
  }
  EXPECT_TRUE(load_overrides({"grpc.listen=0.0.0.0:7670", "grpc.tls_certificate=c", "grpc.tls_key=k"}));
}

TEST(Config, WhatTheHttpServerCannotDoIsRefused) {
  const struct {
    std::vector<std::string> overrides;
    const char* problem;
  } cases[] = {
      {{"http.listen=0.0.0.0:7671"},
       "http.listen: 0.0.0.0:7671 can be reached from other machines, and there it is plain text that anybody may "
       "read; "
       "http.allow_remote: true allows it (or listen on 127.0.0.1)"},
      {{"http.listen=7671"}, "http.listen: '7671' is no HOST:PORT: it has no port"},
      {{"http.max_connections=8", "http.max_event_streams=8"},
       "http.max_event_streams: 8 must be less than max_connections (8): requests need some, too"},
      {{"http.update_period_s=0"}, "http.update_period_s: 0 is out of range (allowed: 0.01 to 60)"},
  };
  for (const auto& c : cases) {
    const auto config = load_overrides(c.overrides);
    ASSERT_FALSE(config) << c.overrides[0];
    EXPECT_NE(config.error().message.find(c.problem), std::string::npos) << config.error().message << "\nnot\n"
                                                                         << c.problem;
  }
  EXPECT_TRUE(load_overrides({"http.listen="}));
  EXPECT_TRUE(load_overrides({"http.listen=0.0.0.0:7671", "http.allow_remote=true"}));
}

TEST(Config, TheExampleOfTheDocumentationIsTaken) {
  std::ifstream file(PLANEMAP_SOURCE_DIR "/docs/lcm.md");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto begin = text.find("```yaml\ninputs:");
  ASSERT_NE(begin, std::string::npos);
  const auto end = text.find("```", begin + 3);
  const auto config = load_text(text.substr(begin + 8, end - begin - 8));
  ASSERT_TRUE(config) << config.error().message;
  ASSERT_EQ(config->inputs.size(), 3u);
  EXPECT_EQ(config->inputs[1].disparity, (std::vector<double>{0.075, 1090.0}));
}

TEST(Config, EachSensorIsOneLine) {
  const auto config = load_text(
      "inputs:\n"
      "  - {name: head, channel: OPENNI_FRAME, intrinsics: [528, 528, 320, 240], pose_channel: POSE_BODY}\n"
      "  - {name: arm, channel: KINECT_FRAME, family: kinect_frame, intrinsics: [594, 591, 339, 242, 640, 480], "
      "disparity: [0.075, 1090], pose_channel: ARM_TO_LOCAL}\n"
      "  - {name: cart, channel: DRAKE_RGBD_CAMERA_IMAGES, frame: depth, intrinsics: [600, 600, 320, 240]}\n");
  ASSERT_TRUE(config) << config.error().message;
  ASSERT_EQ(config->inputs.size(), 3u);
  EXPECT_EQ(config->inputs[0].family, ScanFamily::kAuto);
  EXPECT_EQ(config->inputs[1].family, ScanFamily::kKinectFrame);
  EXPECT_EQ(config->inputs[1].intrinsics.at(4), 640.0);
  EXPECT_EQ(config->inputs[2].frame, "depth");
  EXPECT_EQ(config->inputs[2].pose_channel, "POSE");
}

TEST(Config, CamerasThatCannotBeAreRefused) {
  const struct {
    std::vector<std::string> overrides;
    const char* problem;
  } cases[] = {
      {{"inputs.0.family=laser"},
       "'laser' is not known (allowed: auto, depth_scan, point_scan, kinect_frame, images, image, image_array, "
       "pointcloud2, point_cloud)"},
      {{"inputs.0.family=images"},
       "inputs.0.intrinsics: are missing: the family's messages bring none; [fx, fy, cx, cy] in pixels"},
      {{"inputs.0.intrinsics=[1, 2, 3]"},
       "inputs.0.intrinsics: has 3 numbers, must have 4 (fx, fy, cx, cy) or 6 (width and height, too)"},
      {{"inputs.0.intrinsics=[0, 2, 3, 4]"}, "inputs.0.intrinsics: fx 0 and fy 2 must be above 0"},
      {{"inputs.0.intrinsics=[1, 2, .nan, 4]"}, "inputs.0.intrinsics.2: '.nan' is not a number"},
      {{"inputs.0.intrinsics=[1, 2, 3, 4, 640.5, 480]"},
       "inputs.0.intrinsics: width 640.5 and height 480 must be whole numbers of 1 to 4096 pixels"},
      {{"inputs.0.disparity=[0.075]"},
       "inputs.0.disparity: has 1 number, must have 2 (baseline in metres, offset) or none"},
      {{"inputs.0.disparity=[75, 1090]"},
       "inputs.0.disparity: baseline 75 must be above 0 and at most 1 m, offset 1090 above 0 and at most 10000"},
      {{"inputs.0.depth_unit_m=0"}, "inputs.0.depth_unit_m: 0 is out of range"},
      {{"publish.point_cloud_channel=POSE"},
       "publish.point_cloud_channel: 'POSE' is used by inputs.0.pose_channel, too"},
  };
  for (const auto& c : cases) {
    const auto config = load_overrides(c.overrides);
    ASSERT_FALSE(config) << c.overrides[0];
    EXPECT_NE(config.error().message.find(c.problem), std::string::npos) << config.error().message << "\nnot\n"
                                                                         << c.problem;
  }
}

TEST(Config, UrlGetsAReceiveBufferUnlessItHasOne) {
  const auto url_of = [](const char* url) { return effective_lcm_url({url, 3000000}); };
  EXPECT_EQ(url_of("udpm://239.255.76.67:7667?ttl=0"), "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=3000000");
  EXPECT_EQ(url_of("udpm://239.255.76.67:7667"), "udpm://239.255.76.67:7667?recv_buf_size=3000000");
  EXPECT_EQ(url_of("udpm://239.255.76.67:7667?recv_buf_size=5"), "udpm://239.255.76.67:7667?recv_buf_size=5");
  EXPECT_EQ(url_of("memq://"), "memq://");
  setenv("LCM_DEFAULT_URL", "tcpq://example.org:7700", 1);
  EXPECT_EQ(url_of(""), "tcpq://example.org:7700");
  unsetenv("LCM_DEFAULT_URL");
  EXPECT_EQ(url_of(""), "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=3000000");
}

}  // namespace
}  // namespace planemap::service

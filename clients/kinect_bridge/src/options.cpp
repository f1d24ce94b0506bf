#include "options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <numbers>
#include <planemap/simulation/scenes.hpp>
#include <vector>

#ifndef PLANEMAP_VERSION
#error "PLANEMAP_VERSION is set by the build"
#endif

namespace planemap::kinect_bridge {
namespace {

constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr double kMaxRateHz = 10000.0;

/// What CLI11 fills, where it is not the option itself.
struct Raw {
  std::string camera;
  std::optional<std::size_t> frames;
  double pose_noise_deg = 0.0;
  bool wall_clock = false;
  std::string format = "depth_scan";
  std::string pose_format = "pose";
  std::string encoding;
};

/// A check without words in the help, where the type's name says enough.
template <class Number>
CLI::Validator in_range(Number low, Number high) {
  return CLI::Range(low, high).description("");
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const simulation::SceneInfo& scene : simulation::scenes()) names.emplace_back(scene.name);
  return names;
}

/// For the help: each scene with what it shows.
std::string scenes_text() {
  std::string text = "Scenes:\n";
  for (const simulation::SceneInfo& scene : simulation::scenes()) {
    std::string line = "  " + std::string(scene.name);
    line.resize(20, ' ');
    text += line + std::string(scene.shows) + "\n";
  }
  return text + "\n";
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const ScanTypeInfo& info : scan_types()) names.emplace_back(info.name);
  return names;
}

std::vector<std::string> pose_format_names() {
  std::vector<std::string> names;
  for (const PoseTypeInfo& info : pose_types()) names.emplace_back(info.name);
  return names;
}

/// For the help: each format with the type that it is.
std::string formats_text() {
  std::string text = "Formats:\n";
  for (const ScanTypeInfo& info : scan_types()) {
    std::string line = "  " + std::string(info.name);
    line.resize(20, ' ');
    text += line + info.carries + "\n";
  }
  return text + "\n";
}

void add_source_options(CLI::App& app, Options& options, Raw& raw) {
  auto* source = app.add_option_group("Source", "where the frames come from: one of");
  auto* dataset = source
                      ->add_option("--dataset", options.dataset,
                                   "7-Scenes or TUM RGB-D folder; the body of the pose messages is its camera")
                      ->type_name("FOLDER");
  auto* simulate =
      source->add_option("--simulate", options.simulation.scene, "a rendered scene whose planes are known; see below")
          ->type_name("SCENE")
          ->check(CLI::IsMember(scene_names()).description(""));
  source->require_option(1);

  app.add_option(
         "--frames", raw.frames,
         "stop after N frames; a simulation spreads them evenly over one tour (default: all; one tour of the "
         "apartment at true speed, of a special room in 28 to 100 frames, 20,000 of the building, which has no end)")
      ->type_name("N")
      ->check(in_range(std::size_t{1}, std::size_t{1'000'000'000}));
  app.add_flag("--loop", options.loop, "begin again at the end, until stopped; utimes go on");
  app.add_option("--intrinsics", raw.camera, "fx,fy,cx,cy in pixels, instead of the folder's own")
      ->type_name("FX,FY,CX,CY")
      ->needs(dataset);
  app.add_option("--depth-scale", options.folder.depth_scale_m,
                 "metres per unit of depth (default: 7-Scenes 0.001, TUM 0.0002)")
      ->type_name("M")
      ->check(in_range(1e-9, 1.0))
      ->needs(dataset);
  app.add_option("--seed", options.simulation.seed, "of the scene, its place in the world and the noise")
      ->type_name("N")
      ->capture_default_str()
      ->needs(simulate);
  app.add_option("--time-lapse", options.simulation.time_lapse,
                 "seconds of the tour that pass in a second of the recording")
      ->type_name("FACTOR")
      ->capture_default_str()
      ->check(in_range(0.01, 1000.0))
      ->needs(simulate);
  app.add_option("--truth", options.truth_path,
                 "write the known planes to this file, as planes.json; of the building those seen, at the end")
      ->type_name("FILE")
      ->needs(simulate);
  app.add_option("--noise", options.simulation.depth_noise.scale,
                 "times the depth noise of a Kinect; 0: exact depth, nothing lost")
      ->type_name("FACTOR")
      ->capture_default_str()
      ->check(in_range(0.0, 100.0))
      ->needs(simulate);
  app.add_option("--pose-noise-m", options.simulation.pose_noise.sigma_m, "standard error of positions, each axis")
      ->type_name("M")
      ->capture_default_str()
      ->check(in_range(0.0, 10.0))
      ->needs(simulate);
  app.add_option("--pose-noise-deg", raw.pose_noise_deg, "standard error of rotations, each axis")
      ->type_name("DEG")
      ->capture_default_str()
      ->check(in_range(0.0, 90.0))
      ->needs(simulate);
  app.add_option("--pose-correlation-s", options.simulation.pose_noise.correlation_s,
                 "time in which pose errors wander; 0: new for each frame")
      ->type_name("S")
      ->capture_default_str()
      ->check(in_range(0.0, 1e6))
      ->needs(simulate);
}

void add_output_options(CLI::App& app, Options& options, Raw& raw) {
  app.add_option("--rate", options.feed.rate_hz, "frames a second (default: as recorded; simulation 30)")
      ->type_name("HZ")
      ->check(in_range(0.001, kMaxRateHz));
  app.add_option("--pose-rate", options.feed.pose_rate_hz,
                 "poses a second between the frames, interpolated (default: one with each frame)")
      ->type_name("HZ")
      ->check(in_range(0.001, kMaxRateHz));
  app.add_option("--format", raw.format, "what the scans are sent as, to try out other stacks' types; see below")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(CLI::IsMember(format_names()).description(""));
  app.add_option("--pose-format", raw.pose_format, "what the poses are sent as")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(CLI::IsMember(pose_format_names()));
  app.add_option("--encoding", raw.encoding, "of the depth images (default: zlib where the format knows it, else raw)")
      ->type_name("WORD")
      ->check(CLI::IsMember({"zlib", "raw", "png"}));
  app.add_option("--channel", options.feed.channel, "of the scans")->type_name("NAME")->capture_default_str();
  app.add_option("--pose-channel", options.feed.pose_channel, "of the poses")->type_name("NAME")->capture_default_str();
  auto* url = app.add_option("-l,--lcm-url", options.lcm_url,
                             "where to publish (default: $LCM_DEFAULT_URL, or " + std::string(kDefaultUrl) + ")")
                  ->type_name("URL");
  auto* log =
      app.add_option("--log", options.log_path,
                     "write an LCM event log instead of publishing, as fast as it goes; its times are the frames'")
          ->type_name("FILE");
  log->excludes(url);
  app.add_flag("--wall-clock", raw.wall_clock,
               "stamp a dataset's frames with the present time, as a simulation's are, and not as recorded")
      ->excludes(log);
  app.add_flag("-q,--quiet", options.quiet, "no progress, no summary");
  app.add_flag("--json", options.json, "a summary as JSON on standard output at the end");
}

void check_channel(const std::string& option, const std::string& channel) {
  constexpr std::size_t kMaxChannel = 63;  // LCM's limit
  if (channel.empty() || channel.size() > kMaxChannel) {
    throw CLI::ValidationError(option, "a channel has 1 to 63 characters");
  }
}

WireFormat wire_format(const Options& options, const Raw& raw) {
  WireFormat format;
  for (const ScanTypeInfo& info : scan_types()) {
    if (raw.format != info.name) continue;
    format.scan = info.type;
    const bool is_known =
        raw.encoding.empty() || raw.encoding == "raw" || (raw.encoding == "png" ? info.knows_png : info.knows_zlib);
    if (!is_known) throw CLI::ValidationError("--encoding", raw.format + " knows no " + raw.encoding);
    format.encoding = raw.encoding == "png"                      ? Encoding::kPng
                      : raw.encoding != "raw" && info.knows_zlib ? Encoding::kZlib
                                                                 : Encoding::kRaw;
  }
  for (const PoseTypeInfo& info : pose_types()) {
    if (raw.pose_format == info.name) format.pose = info.type;
  }
  format.pose_sigma_m = options.simulation.pose_noise.sigma_m;
  format.pose_sigma_rad = raw.pose_noise_deg * std::numbers::pi / 180.0;
  return format;
}

/// What follows from the options together.
void complete(Options& options, const Raw& raw) {
  check_channel("--channel", options.feed.channel);
  check_channel("--pose-channel", options.feed.pose_channel);
  if (options.feed.channel == options.feed.pose_channel) {
    throw CLI::ValidationError("--pose-channel", "must be another one than the scans' (--channel)");
  }
  if (!raw.camera.empty()) {
    const auto camera = sources::parse_camera_parameters(raw.camera);
    if (!camera) throw CLI::ValidationError("--intrinsics", camera.error().message);
    options.folder.camera = *camera;
  }
  options.feed.format = wire_format(options, raw);
  const bool simulated = options.dataset.empty();
  const bool logged = !options.log_path.empty();
  if (logged && options.loop && !raw.frames) {
    throw CLI::ValidationError("--loop", "a log would never end: say how long with --frames");
  }
  if (logged && !simulated && options.feed.rate_hz) {
    throw CLI::ValidationError("--rate", "the log of a dataset keeps the recorded times");
  }
  options.feed.wall_clock = !logged && (simulated || raw.wall_clock);
  options.feed.paced = !logged;
  if (simulated) {
    options.simulation.loop = options.loop;
    options.simulation.pose_noise.sigma_rad = raw.pose_noise_deg * std::numbers::pi / 180.0;
    if (options.feed.rate_hz) options.simulation.rate_hz = *options.feed.rate_hz;
    options.simulation.frames = raw.frames;  // a tour's
  }
  // A simulated tour ends by itself; one that is looped for publishing does not.
  if (!simulated || logged) options.feed.frames = raw.frames;
  if (options.lcm_url.empty()) {
    const char* url = std::getenv("LCM_DEFAULT_URL");
    options.lcm_url = url != nullptr && *url != '\0' ? url : kDefaultUrl;
  }
}

}  // namespace

ParsedOptions parse_options(int argc, char** argv) {
  CLI::App app("Feeds planemap: publishes a recorded or a simulated Kinect's depth images and poses over LCM.",
               "planemap-kinect-bridge");
  app.set_version_flag("--version", "planemap-kinect-bridge " PLANEMAP_VERSION, "Print the version and exit");
  app.footer(scenes_text() + formats_text() + "Exit codes: 0 done or stopped by a signal, 1 failed, 2 wrong use.");
  Options options;
  Raw raw;
  add_source_options(app, options, raw);
  add_output_options(app, options, raw);
  try {
    app.parse(argc, argv);
    complete(options, raw);
  } catch (const CLI::ParseError& error) {
    return {std::nullopt, app.exit(error) == 0 ? 0 : 2};
  }
  return {options, 0};
}

}  // namespace planemap::kinect_bridge

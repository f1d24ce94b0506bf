#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "build/build_run.hpp"
#include "build/build_summary.hpp"
#include "command.hpp"
#include "config/map_gravity.hpp"
#include "config/service_config.hpp"
#include "export/export_map.hpp"
#include "export/exporter.hpp"
#include "store/map_reader.hpp"
#include "store/map_store.hpp"

namespace planemap::cli {
namespace {

struct BuildOptions {
  std::string path;
  service::ConfigSources config;
  std::vector<std::string> outputs;
  std::string map;
  std::string intrinsics;
  double depth_scale_m = 0.0;
  std::size_t frames = 0;
  bool json = false;
  bool quiet = false;
};

/// Fills in the input; the error says what is wrong with the arguments.
Expected<BuildInput> input_of(const BuildOptions& options) {
  BuildInput input;
  input.path = options.path;
  const bool is_folder = std::filesystem::is_directory(input.path);
  if (!is_folder && (!options.intrinsics.empty() || options.depth_scale_m > 0.0)) {
    return fail("--intrinsics and --depth-scale are for folders; the scans of a log bring their own");
  }
  if (!options.intrinsics.empty()) {
    const auto camera = sources::parse_camera_parameters(options.intrinsics);
    if (!camera) return fail("--intrinsics: " + camera.error().message);
    input.folder.camera = *camera;
  }
  if (options.depth_scale_m > 0.0) input.folder.depth_scale_m = options.depth_scale_m;
  if (options.frames > 0) input.frames = options.frames;
  return input;
}

/// Whether the settings of scans and poses that come as messages are other than the defaults.
bool has_message_settings(const service::ServiceConfig& config) {
  service::ServiceConfig plain = config;
  plain.inputs = service::ServiceConfig{}.inputs;
  plain.pose = service::PoseConfig{};
  plain.pose.error = config.pose.error;  // the mapper's
  return service::to_yaml(plain) != service::to_yaml(config);
}

ExitCode run(const BuildOptions& options) {
  const auto input = input_of(options);
  if (!input) return complain(ExitCode::kWrongUse, input.error().message);
  for (const std::string& output : options.outputs) {
    if (auto usable = check_export_path(output); !usable) return complain(ExitCode::kWrongUse, usable.error().message);
  }
  if (!options.map.empty()) {
    if (const ExitCode usable = check_new_map_file(options.map); usable != ExitCode::kDone) return usable;
  }
  auto config = service::load_config(options.config);
  if (!config) return complain(ExitCode::kWrongUse, config.error().message);

  if (std::filesystem::is_directory(options.path) && has_message_settings(*config)) {
    std::fprintf(
        stderr,
        "planemap: inputs.* and pose.* are about messages and don't apply to a folder, whose frames bring the camera's "
        "own pose; the ranges that apply are sensor.min_range_m and sensor.max_range_m\n");
  }

  const auto result = build_map(*input, std::move(*config), !options.quiet);
  if (!result) return complain(ExitCode::kFailed, result.error().message);
  const bool anything = result->mapped() > 0;
  const ExportMap map = export_map_of(*result->snapshot, result->config.map.frame, gravity_of(result->config.map));
  std::vector<std::string> exported;
  for (const std::string& output : options.outputs) {
    if (!anything) break;
    if (auto written = export_to(map, output); !written) return complain(ExitCode::kFailed, written.error().message);
    exported.push_back(output);
  }
  if (anything && !options.map.empty()) {
    const auto written = service::write_map_file(options.map, service::facts_of(result->config), result->snapshot);
    if (!written) return complain(ExitCode::kFailed, written.error().message);
    exported.push_back(options.map);
  }
  if (options.json) {
    std::fputs(summary_json(*result, map, exported).c_str(), stdout);
  } else if (!options.quiet) {
    std::fputs(summary_text(*result, map).c_str(), stdout);
    for (const std::string& output : exported) std::printf("written: %s\n", output.c_str());
  }
  return anything ? ExitCode::kDone : complain(ExitCode::kFailed, options.path + ": " + nothing_mapped(*result));
}

}  // namespace

void add_build_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "build", "Build a map from a recording; the same recording and settings give the same files, byte by byte");
  const auto options = std::make_shared<BuildOptions>();
  command->add_option("INPUT", options->path, "LCM event log, 7-Scenes folder or TUM RGB-D folder")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("--preset", options->config.preset, "Method: the best known, or the paper's and nothing more")
      ->check(CLI::IsMember({"best", "paper"}))
      ->capture_default_str();
  command->add_option("--config", options->config.file, "Settings, YAML, as planemapd reads them")->type_name("FILE");
  command->add_option("--set", options->config.overrides, "Override a setting, e.g. grid.cell_size_m=0.05")
      ->type_name("SECTION.KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--export", options->outputs, "Write the map, format by extension: " + known_formats())
      ->type_name("OUT")
      ->allow_extra_args(false);
  command->add_option("--output", options->map, "Write a map file (NAME.planemap), with which planemapd can go on")
      ->type_name("MAP");
  command->add_option("--intrinsics", options->intrinsics, "Camera of a folder's images, pixels")
      ->type_name("FX,FY,CX,CY");
  command->add_option("--depth-scale", options->depth_scale_m, "Metres per unit of a folder's depth images")
      ->check(CLI::Range(1e-9, 1e3));
  command->add_option("--frames", options->frames, "Map at most so many scans")->check(CLI::Range(1, 1000000000));
  command->add_flag("--json", options->json, "Print the summary as one JSON object");
  command->add_flag("--quiet", options->quiet, "No progress, no summary for people");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli

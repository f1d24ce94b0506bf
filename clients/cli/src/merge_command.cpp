#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <planemap/sources/rigid_transform.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "build/progress.hpp"
#include "command.hpp"
#include "merge/map_merge.hpp"
#include "store/map_reader.hpp"

namespace planemap::cli {
namespace {

struct Options {
  std::vector<std::string> maps;
  std::string out;
  std::string transform;
  bool first_settings = false;
  bool json = false;
  bool quiet = false;
};

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code none;
  return std::filesystem::equivalent(a, b, none);
}

/// What is wrong with the names that were given; empty: nothing.
std::string objection_to_names(const Options& options) {
  if (options.maps.size() < 2) return "merge needs two maps or more";
  for (std::size_t i = 0; i < options.maps.size(); ++i) {
    if (is_same_file(options.maps[i], options.out)) {
      return options.out + ": is one of the maps to merge; the sum needs a file of its own";
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (is_same_file(options.maps[i], options.maps[k])) {
        return options.maps[i] + ": is given twice: what it saw would count twice";
      }
    }
  }
  if (std::filesystem::exists(options.out)) return options.out + ": is there already";
  if (!options.transform.empty() && options.maps.size() != 2) {
    return "--transform places the second of two maps: merge more than two step by step";
  }
  return {};
}

std::string summary_json(const Options& options, const std::vector<MergeInput>& inputs, const MergeResult& result) {
  nlohmann::ordered_json json = {{"output", options.out},
                                 {"epoch", result.map->epoch()},
                                 {"revision", result.map->revision()},
                                 {"planeCount", result.map->planes().size()},
                                 {"cellCount", result.map->cell_count()},
                                 {"newPlanes", result.new_planes},
                                 {"mergedPlanes", result.merged_planes},
                                 {"inputs", nlohmann::ordered_json::array()}};
  for (const MergeInput& input : inputs) {
    const auto& map = *input.map.snapshot;
    json["inputs"].push_back({{"file", input.path.string()},
                              {"epoch", map.epoch()},
                              {"revision", map.revision()},
                              {"planeCount", map.planes().size()},
                              {"cellCount", map.cell_count()}});
  }
  return json.dump() + '\n';
}

void print_summary(const Options& options, const std::vector<MergeInput>& inputs, const MergeResult& result) {
  for (const MergeInput& input : inputs) {
    std::printf("%s: %zu planes, %zu cells\n", input.path.c_str(), input.map.snapshot->planes().size(),
                input.map.snapshot->cell_count());
  }
  std::printf("%s: %zu planes, %zu cells\n", options.out.c_str(), result.map->planes().size(),
              result.map->cell_count());
}

ExitCode run(const Options& options) {
  if (const std::string why = objection_to_names(options); !why.empty()) return complain(ExitCode::kWrongUse, why);
  if (const ExitCode usable = check_new_map_file(options.out); usable != ExitCode::kDone) return usable;
  MergeOptions how;
  how.first_settings = options.first_settings;
  if (!options.transform.empty()) {
    const auto transform = sources::read_transform(options.transform);
    if (!transform) return complain(ExitCode::kWrongUse, "--transform: " + transform.error().message);
    how.T_first_second = *transform;
  }
  std::vector<MergeInput> inputs;
  inputs.reserve(options.maps.size());
  for (const std::string& map : options.maps) {
    auto input = read_merge_input(map);
    if (!input) return complain(ExitCode::kFailed, input.error().message);
    inputs.push_back(std::move(*input));
  }
  if (const std::string why = objection_to(inputs, how); !why.empty()) return complain(ExitCode::kFailed, why);
  Expected<MergeResult> result;
  {
    Progress progress(!options.quiet);
    result = merge_maps(inputs, how, [&](double share) {
      if (progress.due()) progress.show(share, "merging");
    });
  }
  if (!result) return complain(ExitCode::kFailed, result.error().message);
  if (auto written = service::write_map_file(options.out, result->facts, result->map); !written) {
    return complain(ExitCode::kFailed, written.error().message);
  }
  if (options.json) {
    std::fputs(summary_json(options, inputs, *result).c_str(), stdout);
  } else if (!options.quiet) {
    print_summary(options, inputs, *result);
  }
  return ExitCode::kDone;
}

}  // namespace

void add_merge_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "merge",
      "Add up map files: what each has seen counts, as if one had seen it all; the first one's planes keep their ids");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("MAP", options->maps,
                   "Map files, two or more, with cells of one size; of one frame without --transform")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("-o,--output", options->out, "New map file")->required();
  command
      ->add_option("--transform", options->transform,
                   "Takes the second map's coordinates to the first one's: x,y,z,qx,qy,qz,qw (m, unit quaternion), the "
                   "16 numbers of a row-major 4x4 matrix, or a file with either")
      ->type_name("NUMBERS|FILE");
  command->add_flag("--first-settings", options->first_settings,
                    "Merge maps that were mapped with other settings, too, with those of the first");
  command->add_flag("--json", options->json, "Print the summary as one JSON object");
  command->add_flag("--quiet", options->quiet, "No progress, no summary for people");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli

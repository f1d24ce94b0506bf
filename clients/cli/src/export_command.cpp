#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "command.hpp"
#include "daemon_options.hpp"
#include "export/export_map_of_wire.hpp"
#include "export/exporter.hpp"
#include "store/map_file.hpp"

namespace planemap::cli {
namespace {

struct ExportOptions {
  DaemonOptions daemon;
  std::string from;
  std::vector<std::string> outputs;
  bool quiet = false;
};

ExitCode write(const ExportMap& map, const ExportOptions& options) {
  for (const std::string& output : options.outputs) {
    if (auto written = export_to(map, output); !written) return complain(ExitCode::kFailed, written.error().message);
    if (!options.quiet) std::printf("%s\n", output.c_str());
  }
  return ExitCode::kDone;
}

ExitCode run(const ExportOptions& options) {
  for (auto output = options.outputs.begin(); output != options.outputs.end(); ++output) {
    if (std::find(options.outputs.begin(), output, *output) == output) continue;
    return complain(ExitCode::kWrongUse, *output + ": is named more than once");
  }
  for (const std::string& output : options.outputs) {
    if (auto usable = check_export_path(output); !usable) return complain(ExitCode::kWrongUse, usable.error().message);
  }
  if (options.from != "-") {
    if (!std::filesystem::exists(options.from)) {
      return complain(ExitCode::kWrongUse, options.from + ": there is no such file; '-' asks the running daemon");
    }
    const auto stored = service::MapFile::read(options.from);
    if (!stored) return complain(ExitCode::kFailed, stored.error().message);
    return write(export_map_of(*stored->snapshot, stored->facts.frame, stored->facts.gravity_direction()), options);
  }
  const auto client = connect(options.daemon);
  if (!client) return client.error();
  const auto answer = (*client)->whole_map(2 * options.daemon.timeout());  // the planes, then the cells
  if (!answer) return complain(answer.error(), options.daemon);
  const auto map = export_map_of(*answer);
  if (!map) return complain(ExitCode::kFailed, map.error().message);
  return write(*map, options);
}

}  // namespace

void add_export_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("export", "Write the map of a file, or of the daemon, to files");
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("MAP", options->from, "Map file; - asks the running daemon")->required();
  command->add_option("OUT", options->outputs, "Files to write, format by extension: " + known_formats())->required();
  add_daemon_options(*command, options->daemon);
  command->add_flag("--quiet", options->quiet, "Don't print the names of the files");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli

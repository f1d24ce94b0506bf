#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "command.hpp"
#include "daemon_options.hpp"
#include "export/export_map_of_wire.hpp"
#include "export/formats.hpp"
#include "plane_table.hpp"

namespace planemap::cli {
namespace {

struct SnapshotOptions {
  DaemonOptions daemon;
  bool json = false;
};

ExitCode run(const SnapshotOptions& options) {
  const auto client = connect(options.daemon);
  if (!client) return client.error();
  const auto answer = (*client)->snapshot(options.daemon.timeout());
  if (!answer) return complain(answer.error(), options.daemon);
  const auto map = export_map_of(*answer);
  if (!map) return complain(ExitCode::kFailed, map.error().message);
  if (options.json) {
    write_planes_json(*map, std::cout);
  } else {
    std::cout << fmt::format("map {}, revision {}, frame {}; planes: {}\n", map->epoch, map->revision, map->frame,
                             map->planes.size())
              << plane_table(*map);
  }
  std::cout.flush();
  return std::cout ? ExitCode::kDone : complain(ExitCode::kFailed, "the output can't be written");
}

}  // namespace

void add_snapshot_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("snapshot", "Ask the daemon for its planes");
  const auto options = std::make_shared<SnapshotOptions>();
  add_daemon_options(*command, options->daemon);
  command->add_flag("--json", options->json, "Print planes.json instead of a table");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli

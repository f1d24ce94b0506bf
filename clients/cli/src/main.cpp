#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "command.hpp"

#ifndef PLANEMAP_VERSION
#error "PLANEMAP_VERSION is set by the build"
#endif

namespace planemap::cli {
namespace {

/// What to say of a command that does not exist; CLI11 would only say that one is required. Empty: nothing.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  std::string known;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return {};
    known += (known.empty() ? "" : ", ") + command->get_name();
  }
  return std::string("there is no command '") + argv[1] + "'; there are " + known;
}

ExitCode run(int argc, char** argv) {
  CLI::App app("Builds plane maps from recorded scans, and asks a running planemapd for its map.", "planemap");
  app.set_version_flag("--version", "planemap " PLANEMAP_VERSION, "Print the version and exit");
  app.require_subcommand(1);
  app.footer("Exit codes: 0 done, 1 failed, 2 wrong use, 3 no daemon answered. 'planemap COMMAND --help' tells more.");
  Action action;
  add_build_command(app, action);
  add_status_command(app, action);
  add_snapshot_command(app, action);
  add_export_command(app, action);
  add_nearest_command(app, action);
  add_ray_command(app, action);
  add_region_command(app, action);
  add_plane_command(app, action);
  add_floorplan_command(app, action);
  add_watch_command(app, action);
  add_admin_commands(app, action);
  add_map_commands(app, action);
  add_merge_command(app, action);
  if (const std::string unknown = unknown_command(app, argc, argv); !unknown.empty()) {
    return complain(ExitCode::kWrongUse, unknown);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kWrongUse;
  }
  const ExitCode code = action();
  // What was printed may still wait in the buffer: a full disk is seen only now.
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    return complain(ExitCode::kFailed, "the output could not be written: is the disk full?");
  }
  return code;
}

}  // namespace

ExitCode complain(ExitCode code, const std::string& message) {
  std::fprintf(stderr, "planemap: %s\n", message.c_str());
  return code;
}

}  // namespace planemap::cli

int main(int argc, char** argv) {
  using planemap::cli::complain;
  using planemap::cli::ExitCode;
  try {
    return static_cast<int>(planemap::cli::run(argc, argv));
  } catch (const std::exception& error) {
    return static_cast<int>(complain(ExitCode::kFailed, error.what()));
  }
}

#pragma once

#include <functional>
#include <string>

#include "exit_code.hpp"

namespace CLI {
class App;
}

namespace planemap::cli {

/// What a subcommand does once the arguments are read.
using Action = std::function<ExitCode()>;

/// Each adds its subcommand to the program; when it was the one asked for, `action` is set.
void add_build_command(CLI::App& app, Action& action);
void add_status_command(CLI::App& app, Action& action);
void add_snapshot_command(CLI::App& app, Action& action);
void add_export_command(CLI::App& app, Action& action);
void add_nearest_command(CLI::App& app, Action& action);
void add_ray_command(CLI::App& app, Action& action);
void add_region_command(CLI::App& app, Action& action);
void add_plane_command(CLI::App& app, Action& action);
void add_floorplan_command(CLI::App& app, Action& action);
void add_watch_command(CLI::App& app, Action& action);
/// pause, resume, reset and save.
void add_admin_commands(CLI::App& app, Action& action);
/// info and recover.
void add_map_commands(CLI::App& app, Action& action);
void add_merge_command(CLI::App& app, Action& action);

/// Whether a map file could be written there, and none that is in use would be replaced; else says what is wrong.
ExitCode check_new_map_file(const std::string& path);
/// Copies a map file consistently, also one that planemapd is writing.
ExitCode copy_map_file(const std::string& map, const std::string& copy);

/// Says on stderr what went wrong: "planemap: ...".
ExitCode complain(ExitCode code, const std::string& message);

}  // namespace planemap::cli

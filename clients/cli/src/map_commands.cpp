// What is done with a map file (NAME.planemap): info, recover, and a copy of it.

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "command.hpp"
#include "common/clock.hpp"
#include "store/file_lock.hpp"
#include "store/map_reader.hpp"

namespace planemap::cli {
namespace {

using service::MapFile;
using service::StoredMap;

struct MapOptions {
  std::string map;
  std::string out;
  bool json = false;
};

std::string info_json(const StoredMap& map) {
  const auto& s = *map.snapshot;
  const nlohmann::ordered_json json = {{"format", map.format},         {"version", map.facts.version},
                                       {"frame", map.facts.frame},     {"gravity", map.facts.gravity},
                                       {"epoch", s.epoch()},           {"revision", s.revision()},
                                       {"utime", s.utime()},           {"planeCount", s.planes().size()},
                                       {"cellCount", s.cell_count()},  {"blockCount", s.block_count()},
                                       {"cellSizeM", s.cell_size_m()}, {"nextPlaneId", s.state().next_plane_id},
                                       {"closed", map.closed},         {"bytes", map.bytes},
                                       {"config", map.facts.config}};
  return json.dump() + '\n';
}

std::string info_text(const StoredMap& map) {
  const auto& s = *map.snapshot;
  std::string text;
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("{:<10} {}\n", name, value);
  };
  line("format", fmt::format("{}, written by planemap {}", map.format, map.facts.version));
  line("frame", map.facts.frame);
  line("gravity", map.facts.gravity.empty() ? "not known" : map.facts.gravity);
  line("map", fmt::format("epoch {}, revision {}", s.epoch(), s.revision()));
  line("holds", fmt::format("{} planes, {} cells of {} m in {} blocks", s.planes().size(), s.cell_count(),
                            s.cell_size_m(), s.block_count()));
  line("last scan", fmt::format("utime {}", s.utime()));
  line("file", fmt::format("{} B{}", map.bytes,
                           s.cell_count() == 0
                               ? ""
                               : fmt::format(", {:.1f} a cell",
                                             static_cast<double>(map.bytes) / static_cast<double>(s.cell_count()))));
  line("state", map.closed ? "whole, closed in good order" : "whole, open or not closed in good order");
  return text;
}

ExitCode info(const MapOptions& options) {
  const auto map = MapFile::read(options.map);
  if (!map) return complain(ExitCode::kFailed, map.error().message);
  std::fputs((options.json ? info_json(*map) : info_text(*map)).c_str(), stdout);
  return ExitCode::kDone;
}

ExitCode recover(const MapOptions& options) {
  if (ExitCode usable = check_new_map_file(options.out); usable != ExitCode::kDone) return usable;
  if (std::filesystem::exists(options.out)) return complain(ExitCode::kWrongUse, options.out + ": is there already");
  auto recovered = service::recover_map(options.map);
  if (!recovered) return complain(ExitCode::kFailed, recovered.error().message);
  // A life of its own: the damaged map's later revisions were seen, and are lost.
  auto parts = recovered->map.continued();
  parts.epoch = static_cast<std::uint64_t>(service::utime_now());
  const auto map = std::make_shared<const MapSnapshot>(std::move(parts));
  if (auto written = service::write_map_file(options.out, recovered->map.facts, map); !written) {
    return complain(ExitCode::kFailed, written.error().message);
  }
  std::printf("%s: %zu planes, %zu cells recovered; lost: %zu blocks, %zu planes\n", options.out.c_str(),
              map->planes().size(), map->cell_count(), recovered->lost_blocks, recovered->lost_planes);
  return ExitCode::kDone;
}

CLI::App* add(CLI::App& app, Action& action, const char* name, const char* help, ExitCode (*run)(const MapOptions&),
              const std::shared_ptr<MapOptions>& options) {
  CLI::App* command = app.add_subcommand(name, help);
  command->add_option("MAP", options->map, "Map file")->required()->check(CLI::ExistingFile);
  command->callback([options, run, &action] { action = [options, run] { return run(*options); }; });
  return command;
}

}  // namespace

ExitCode check_new_map_file(const std::string& path) {
  const auto folder = std::filesystem::absolute(path).parent_path();
  std::error_code none;
  if (!std::filesystem::is_directory(folder, none)) {
    return complain(ExitCode::kWrongUse, path + ": there is no folder " + folder.string());
  }
  if (std::filesystem::is_directory(path, none)) return complain(ExitCode::kWrongUse, path + ": is a folder");
  if (std::filesystem::exists(path + ".lock", none)) {
    if (auto lock = service::FileLock::take(path); !lock) return complain(ExitCode::kFailed, lock.error().message);
  }
  return ExitCode::kDone;
}

ExitCode copy_map_file(const std::string& map, const std::string& copy) {
  std::error_code none;
  if (std::filesystem::equivalent(map, copy, none)) {
    return complain(ExitCode::kWrongUse, copy + ": a file cannot be copied onto itself");
  }
  if (ExitCode usable = check_new_map_file(copy); usable != ExitCode::kDone) return usable;
  auto database = service::open_database(map, service::Database::Access::kRead);
  if (!database) return complain(ExitCode::kFailed, database.error().message);
  if (auto copied = service::copy_database(*database, copy); !copied) {
    return complain(ExitCode::kFailed, copied.error().message);
  }
  std::printf("%s\n", copy.c_str());
  return ExitCode::kDone;
}

void add_map_commands(CLI::App& app, Action& action) {
  const auto options = std::make_shared<MapOptions>();
  add(app, action, "info", "Verify a map file, and tell what is in it", info, options)
      ->add_flag("--json", options->json, "Print one JSON object");
  add(app, action, "recover", "Take out of a damaged map file what is whole", recover, options)
      ->add_option("-o,--output", options->out, "New map file")
      ->required();
}

}  // namespace planemap::cli

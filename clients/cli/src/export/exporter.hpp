#pragma once

#include <filesystem>
#include <planemap/expected.hpp>
#include <string>

#include "export/export_map.hpp"

namespace planemap::cli {

/// Whether a map can be written to that path: its extension is known and its folder is there. The error lists the
/// extensions that are known. To be asked before the work that leads to the map.
Expected<void> check_export_path(const std::filesystem::path& path);

/// Writes a map in the format that the path's extension names. The file appears whole or not at all.
Expected<void> export_to(const ExportMap& map, const std::filesystem::path& path);

/// The known extensions and what they hold, for --help: ".json (planes), ...".
std::string known_formats();

}  // namespace planemap::cli

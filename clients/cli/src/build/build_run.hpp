#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/scan.hpp>
#include <planemap/snapshot.hpp>
#include <planemap/sources/open_folder.hpp>
#include <string>

#include "config/service_config.hpp"
#include "mapping/stage_times.hpp"

namespace planemap::cli {

/// What a map is built from.
struct BuildInput {
  std::filesystem::path path;         ///< LCM event log, or folder of 7-Scenes or TUM RGB-D
  sources::FolderOptions folder;      ///< for folders
  std::optional<std::size_t> frames;  ///< at most so many scans
};

/// A map, and how it came about.
struct BuildResult {
  std::shared_ptr<const MapSnapshot> snapshot;
  service::ServiceConfig config;  ///< with what the input adds to it: gravity
  std::map<std::string, std::int64_t> counters;
  std::map<std::string, std::size_t> skipped;   ///< frames of a folder, by reason
  std::map<std::string, std::size_t> channels;  ///< events of a log, by channel
  std::uint64_t gaps = 0;                       ///< damaged stretches of a log
  std::uint64_t gap_bytes = 0;
  PointCounts points;
  service::StageTimes times;
  std::string last_problem;  ///< why the last unmapped scan was not mapped; empty: none
  double seconds = 0.0;      ///< from opening the input to the map

  std::int64_t mapped() const;  ///< scans
};

/// Builds a map. Fails if the input can't be opened, or is neither a log nor a folder of a known kind.
/// @param config    as load_config gave it
/// @param progress  whether to show it on a terminal
Expected<BuildResult> build_map(const BuildInput& input, service::ServiceConfig config, bool progress);

}  // namespace planemap::cli

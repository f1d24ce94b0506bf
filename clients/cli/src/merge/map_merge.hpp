#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/snapshot.hpp>
#include <string>
#include <vector>

#include "config/service_config.hpp"
#include "store/map_file.hpp"

namespace planemap::cli {

/// A map that is to be merged, as its file has it.
struct MergeInput {
  std::filesystem::path path;
  service::StoredMap map;
  service::ServiceConfig config;  ///< that it was mapped with
};

/// Reads and verifies a map file; also one that planemapd is writing.
Expected<MergeInput> read_merge_input(const std::filesystem::path& path);

struct MergeOptions {
  /// From the second map's frame to the first one's; empty: all maps are of one frame.
  std::optional<Eigen::Isometry3d> T_first_second;
  /// Merge though the methods' settings differ; those of the first map hold.
  bool first_settings = false;
};

/// Why the maps do not go together, in a sentence that names the files; empty: they do. Looked at are cell sizes,
/// frames and directions of gravity, the settings of the method, and whether two of them are states of one map.
/// @pre there are at least two; two where there is a transform
std::string objection_to(const std::vector<MergeInput>& inputs, const MergeOptions& options);

struct MergeResult {
  std::shared_ptr<const MapSnapshot> map;
  service::MapFacts facts;
  std::size_t new_planes = 0;     ///< that the others brought, those included that were then merged
  std::size_t merged_planes = 0;  ///< that became part of others
};

/// Adds the maps to the first one, whose planes keep their ids; the sum is of an epoch of its own, that the same inputs
/// give again. Times are the greatest of all.
/// @param progress  called now and then with the share that is done, 0 to 1
/// @pre objection_to() has none
Expected<MergeResult> merge_maps(const std::vector<MergeInput>& inputs, const MergeOptions& options,
                                 const std::function<void(double share)>& progress = {});

}  // namespace planemap::cli

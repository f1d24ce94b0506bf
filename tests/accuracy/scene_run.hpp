#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <planemap/config.hpp>
#include <planemap/snapshot.hpp>
#include <planemap/sources/frame_source.hpp>
#include <string>
#include <vector>

#include "seen_surfaces.hpp"
#include "summary.hpp"

namespace planemap::accuracy {

/// One rendered scene to be mapped.
struct RunConfig {
  std::string scene = "apartment";  ///< one of simulation::scenes()
  std::uint64_t seed = 1;
  std::optional<std::size_t> frames;  ///< empty: 300 of the apartment, a special room's own number
  std::optional<std::size_t> until;   ///< the map is scored after so many of the frames; empty: after all
  MapperConfig mapping = preset(Preset::kBest);
  double noise_scale = 1.0;
  double pose_sigma_m = 0.0;
  double pose_sigma_deg = 0.0;
  double pose_correlation_s = 0.0;
  ScoreOptions scoring;
};

/// A scene and the map that was made of it.
struct MappedScene {
  std::shared_ptr<const MapSnapshot> map;
  SeenSurfaces seen;
  double ms_per_scan = 0.0;    ///< mean, milliseconds
  std::size_t worn_cells = 0;  ///< taken away, though nothing moves
};

/// A rendered scene, to be mapped more than once.
struct RecordedScene {
  std::vector<sources::Frame> frames;
  SeenSurfaces seen;
};

/// Renders the scene. Takes 0.6 MB for a frame.
RecordedScene record_scene(const RunConfig& config);

/// Maps the frames of a recorded scene.
/// @param shuffle  seed of a random order of the frames, the same on every machine; empty: as they were recorded
std::shared_ptr<const MapSnapshot> map_frames(const RecordedScene& scene, const MapperConfig& mapping,
                                              std::optional<std::uint64_t> shuffle = {});

/// Renders the scene and maps it.
MappedScene map_scene(const RunConfig& config);

/// Renders the scene, maps it and scores the map.
Run run_scene(const RunConfig& config);

}  // namespace planemap::accuracy

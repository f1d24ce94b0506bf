#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <planemap/config.hpp>
#include <planemap/mapper.hpp>
#include <planemap/snapshot.hpp>
#include <planemap/sources/frame_source.hpp>
#include <string>
#include <vector>

namespace planemap::experiments {

/// One scan on its way through the mapper.
struct ScanRecord {
  double time_s = 0.0;                            ///< since the first scan
  std::array<double, kStageCount> stage_ms = {};  ///< by stage
  std::size_t points = 0;                         ///< mapped
  std::size_t planes = 0;                         ///< in the map after it
  std::size_t large_planes = 0;                   ///< of those, planes of at least kLargeCells cells

  static constexpr std::uint32_t kLargeCells = 12;
  double total_ms() const;
};

/// A recording mapped by one preset.
struct PresetRun {
  std::string name;
  MapperConfig config;
  std::vector<ScanRecord> scans;
  std::shared_ptr<const MapSnapshot> map;
};

/// A recording mapped by both presets, and its points accumulated for who works offline.
struct SceneRun {
  std::string name;                        ///< a word for file names, "kitchen"
  std::string title;                       ///< in words, "Red kitchen"
  Eigen::Vector3d up;                      ///< world frame, unit
  std::vector<PresetRun> presets;          ///< best, paper
  std::vector<Eigen::Vector3d> sensors_m;  ///< where the sensor was, scan by scan, world frame
  std::vector<Eigen::Vector3f> cloud_m;    ///< world frame, thinned out to one point in a cube

  double leaf_m = 0.0;       ///< edge of that cube
  std::vector<Plane> truth;  ///< planes of the surfaces, where they are known

  const PresetRun& best() const { return presets[0]; }
  const PresetRun& paper() const { return presets[1]; }
};

/// Maps all frames of a source. Each frame goes through both presets before the next one, so that a slow moment of the
/// machine hits both. Throws std::runtime_error where there is no frame.
/// @param leaf_m    edge of the cubes that the accumulated cloud is thinned out to
/// @param on_frame  called after each frame with the number of frames done
SceneRun map_scene(const std::string& name, const std::string& title, sources::FrameSource& source, double leaf_m,
                   const std::function<void(std::size_t)>& on_frame = {});

}  // namespace planemap::experiments

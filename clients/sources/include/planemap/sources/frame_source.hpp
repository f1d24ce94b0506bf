#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/scan.hpp>
#include <string>

namespace planemap::sources {

/// A depth image and where its camera was.
struct Frame {
  DepthScan scan;
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
};

/// Frames in the order in which they were taken.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// The next frame; empty at the end. Frames that can't be used are skipped and counted by skipped().
  virtual std::optional<Frame> next() = 0;
  /// How many frames there are; empty where that is not known.
  virtual std::optional<std::size_t> size() const = 0;
  /// Frames that were passed over so far, by reason in words.
  virtual const std::map<std::string, std::size_t>& skipped() const = 0;
  /// Unit vector that points down in the world frame, where the source knows it.
  virtual std::optional<Eigen::Vector3d> gravity_direction() const = 0;
};

}  // namespace planemap::sources

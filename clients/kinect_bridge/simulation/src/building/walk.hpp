#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "../camera_sample.hpp"
#include "wing.hpp"

namespace planemap::simulation {

/// A robot's way through an endless building: through each corridor and into each of its rooms, where it turns once
/// about itself. About 1 m^2 of new floor comes into sight in a second.
class Walk {
 public:
  explicit Walk(std::uint64_t seed);

  /// Where the camera is. Smooth. Time must not go back by more than a second.
  Eigen::Isometry3d T_scene_sensor(double time_s);

 private:
  const CameraSample& smoothed(std::size_t index);
  void go_through_next_wing();

  std::uint64_t seed_;
  std::size_t wing_ = 0;          // the next one
  std::deque<CameraSample> raw_;  // from first_raw_ on
  std::size_t first_raw_ = 0;
  std::deque<CameraSample> smoothed_;  // from first_smoothed_ on
  std::size_t first_smoothed_ = 0;
  std::vector<double> weights_;  // of the smoothing
};

}  // namespace planemap::simulation

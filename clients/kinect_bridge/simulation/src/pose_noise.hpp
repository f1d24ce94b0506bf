#pragma once

#include <Eigen/Geometry>
#include <planemap/simulation/simulated_source.hpp>

#include "random.hpp"

namespace planemap::simulation {

/// Errors of a tracker: each axis a first-order Gauss-Markov process, white where the correlation time is 0.
class PoseNoise {
 public:
  /// Throws std::invalid_argument if a setting is out of its range.
  PoseNoise(const PoseNoiseConfig& config, const Random& random);

  /// The published pose for a true one, some time after the last.
  Eigen::Isometry3d disturb(const Eigen::Isometry3d& T_world_sensor, double elapsed_s);

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  PoseNoiseConfig config_;
  Random random_;
  Vector6d state_ = Vector6d::Zero();  // of variance 1: position, rotation
  bool started_ = false;
};

}  // namespace planemap::simulation

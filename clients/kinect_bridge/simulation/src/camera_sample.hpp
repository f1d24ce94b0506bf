#pragma once

#include <Eigen/Geometry>

namespace planemap::simulation {

/// A camera on a robot at one instant, upright but for its pitch.
struct CameraSample {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< scene's frame
  double yaw_rad = 0.0;                                  ///< about z, continuous: not wrapped
  double pitch_rad = 0.0;                                ///< up is positive
};

// How a robot drives and turns.
constexpr double kSampleS = 0.05;  ///< from sample to sample of a motion
constexpr double kSpeedMPerS = 0.45;
constexpr double kTurnRadPerS = 0.75;    ///< while turning on the spot
constexpr double kMaxTurnRadPerS = 1.2;  ///< at any time
constexpr double kSmoothingS = 0.5;      ///< standard deviation of the smoothing of the motion
constexpr double kCameraHeightM = 1.2;
constexpr double kCameraHeightSwayM = 0.08;

/// Between two samples: share 0 is a, 1 is b.
CameraSample between(const CameraSample& a, const CameraSample& b, double share);
/// Takes sensor coordinates (x right, y down, z forward) to the scene's.
Eigen::Isometry3d T_scene_sensor(const CameraSample& sample);

}  // namespace planemap::simulation

#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "apartment.hpp"
#include "camera_sample.hpp"

namespace planemap::simulation {

/// Something to look at.
struct View {
  Eigen::Vector3d point_m;  ///< apartment's frame
  Eigen::Vector3d normal;   ///< unit: the side to look from
};

/// Where the camera is and where it looks.
struct Station {
  Eigen::Vector3d position_m;  ///< scene's frame
  Eigen::Vector3d target_m;    ///< in the middle of the image; not straight above or below
};

/// A camera's round through a scene, ending where it began.
class Tour {
 public:
  /// A robot's through all rooms of an apartment: in each room it turns once about itself in the middle, looking up and
  /// down, then drives along the walls and looks across the room. Empty if a room can't be reached, or only through a
  /// gap that is too narrow.
  /// @param views  what to go and look at besides
  static std::optional<Tour> plan(const Apartment& apartment, const std::vector<View>& views);
  /// From station to station on straight lines, and from the last one back to the first. @pre there is one
  static Tour through(const std::vector<Station>& stations);

  double duration_s() const;
  /// Where the camera is. Smooth, and periodic in the duration.
  Eigen::Isometry3d T_scene_sensor(double time_s) const;

 private:
  friend class TourPlanner;
  /// @param raw  one round, its last yaw equal to its first but for whole turns
  explicit Tour(const std::vector<CameraSample>& raw);
  /// Appends the way from the last sample to a goal, as fast as the robot drives and turns.
  static void go_on(const CameraSample& goal, std::vector<CameraSample>& raw);

  std::vector<CameraSample> samples_;  // every kSampleS; the last one is one sample before the first of the next round
  double turn_rad_ = 0.0;              // by which yaw grows in a round: a multiple of 2 pi
};

}  // namespace planemap::simulation

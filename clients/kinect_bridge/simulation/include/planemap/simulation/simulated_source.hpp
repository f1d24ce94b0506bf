#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <planemap/scan.hpp>
#include <planemap/simulation/kinect_sensor.hpp>
#include <planemap/simulation/surface.hpp>
#include <planemap/sources/frame_source.hpp>
#include <span>
#include <string>
#include <vector>

namespace planemap::simulation {

/// How the published poses differ from the true ones. Each axis on its own, in the sensor frame.
struct PoseNoiseConfig {
  double sigma_m = 0.0;        ///< standard deviation of the position along each axis
  double sigma_rad = 0.0;      ///< standard deviation of the rotation about each axis
  double correlation_s = 0.0;  ///< time constant of the errors (first-order Gauss-Markov); 0: white
};

/// A simulated recording.
struct SimulationConfig {
  std::string scene = "apartment";    ///< one of scenes()
  std::uint64_t seed = 1;             ///< of the apartment, of a room's place in the world, and of the noise
  std::optional<std::size_t> frames;  ///< spread evenly over one tour; empty: a special room's own number, or as many
                                      ///< as the rate gives. The building's tour has no end: so many frames at the
                                      ///< rate; empty: 20,000
  double time_lapse = 1.0;            ///< seconds of the tour that pass in a second of the recording
  bool loop = false;                  ///< go round for ever, each time with new noise
  double rate_hz = 30.0;              ///< of the frames' utimes; the first one is at kFirstUtime
  PinholeIntrinsics intrinsics{640, 480, 585.0, 585.0, 320.0, 240.0};
  DepthNoiseConfig depth_noise;
  PoseNoiseConfig pose_noise;
};

constexpr std::int64_t kFirstUtime = 1'000'000;  ///< microseconds

/// A Kinect goes through a rendered scene whose planes are known. Deterministic: the same
/// configuration gives the same frames.
class SimulatedSource final : public sources::FrameSource {
 public:
  /// Builds the scene and plans the tour. Throws std::invalid_argument if a setting is out of its range.
  explicit SimulatedSource(const SimulationConfig& config);
  ~SimulatedSource() override;

  std::optional<sources::Frame> next() override;
  std::optional<std::size_t> size() const override;                    ///< empty with loop
  const std::map<std::string, std::size_t>& skipped() const override;  ///< always empty
  std::optional<Eigen::Vector3d> gravity_direction() const override;

  /// All surfaces of the scene, by id (1, 2, ...), world frame. Of the building what was seen of them so far, with gaps
  /// between the ids, which takes a while; valid until the next call.
  const std::vector<Surface>& truth() const;
  /// Time that one tour takes at the robot's true speed; of the building, what its frames show.
  double tour_s() const;

  // What is known about the frame that next() gave last; empty spans before the first.

  /// Row-major, width * height: the surface in each pixel's line of sight, kNoSurface where there is none. Also set
  /// where the frame has no return: mask with its depth where that matters. In the building nothing is drawn that is
  /// too far away for any return.
  std::span<const SurfaceId> label_image() const;
  /// Row-major, width * height: exact depth, metres; 0 where there is no surface.
  std::span<const float> true_depth_m() const;
  /// Where the camera really was; the frame's own pose has the pose noise.
  const Eigen::Isometry3d& true_T_world_sensor() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::simulation

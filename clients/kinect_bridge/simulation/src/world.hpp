#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <planemap/simulation/renderer.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/simulation/surface.hpp>
#include <vector>

namespace planemap::simulation {

/// What a camera is taken through: where it is in each frame, and what it sees there.
class World {
 public:
  virtual ~World() = default;

  /// @param index  of the frame; never less than that of the call before
  virtual Eigen::Isometry3d T_world_sensor(std::size_t index) = 0;
  /// What the camera sees from there; valid until the next call. Always with the same renderer.
  virtual const RenderedImage& look(Renderer& renderer, const Eigen::Isometry3d& T_world_sensor) = 0;
  /// As SimulatedSource::truth().
  virtual const std::vector<Surface>& truth() = 0;
  virtual Eigen::Vector3d down() const = 0;  ///< unit vector, world frame
  virtual double tour_s() const = 0;         ///< of the robot's time
  virtual std::size_t frames() const = 0;    ///< of one tour
};

/// The world of the scene that the configuration names. Throws std::invalid_argument if there is none.
std::unique_ptr<World> make_world(const SimulationConfig& config);

/// Corridors and rooms without end.
std::unique_ptr<World> make_building_world(const SimulationConfig& config);

}  // namespace planemap::simulation

#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <planemap/simulation/surface.hpp>
#include <string_view>
#include <vector>

#include "random.hpp"
#include "tour.hpp"

namespace planemap::simulation {

/// What there is to see, and how a camera goes through it.
struct Scene {
  Eigen::Isometry3d T_world_scene;
  std::vector<Surface> surfaces;  ///< world frame, ids 1, 2, ...
  Tour tour;
  std::optional<std::size_t> frames;  ///< that show it in one tour; empty: as many as the rate gives at true speed
};

/// The scene of that name. Throws std::invalid_argument if there is none.
Scene make_scene(std::string_view name, Random& random);

/// An apartment that a robot can drive through and see.
Scene make_apartment_scene(Random& random);

}  // namespace planemap::simulation

#pragma once

#include <Eigen/Geometry>
#include <planemap/simulation/surface.hpp>
#include <vector>

#include "floor_plan.hpp"
#include "furniture.hpp"
#include "surface_builder.hpp"

namespace planemap::simulation {

/// A furnished floor plan and where it lies in the world.
struct Apartment {
  FloorPlan plan;
  std::vector<Furniture> furniture;
  Eigen::Isometry3d T_world_apartment = Eigen::Isometry3d::Identity();
};

/// A random place in the world: turned by any angle, moved and tilted by a degree, so that nothing lies along a grid.
Eigen::Isometry3d random_placement(Random& random);

/// A random apartment at a random place.
Apartment make_apartment(Random& random);

/// Everything that can be seen, ids 1, 2, ... Left out: backs against walls, undersides and tops above eye level.
std::vector<Surface> make_surfaces(const Apartment& apartment);
/// The same, to be gone on with.
void add_surfaces(const Apartment& apartment, SurfaceBuilder& builder);

}  // namespace planemap::simulation

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <planemap/plane.hpp>
#include <string>
#include <vector>

namespace planemap::simulation {

/// Names a surface of a scene; 0 is none.
using SurfaceId = std::uint32_t;
constexpr SurfaceId kNoSurface = 0;

/// A convex polygon in space: its corners in order, without the first again at the end, world frame, metres.
using ConvexPiece = std::vector<Eigen::Vector3d>;

/// One plane surface of a scene, seen from its free side only. Pieces that physically are one surface (the wall left
/// and right of a door, the floor through a doorway) are one surface; different things are different ones, coplanar or
/// not.
struct Surface {
  SurfaceId id = kNoSurface;
  std::string name;  ///< in words, for instance "table 2 top"
  Plane plane = Plane::through(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());  ///< normal towards the free side
  PlaneClass plane_class = PlaneClass::kOther;
  bool facet = false;                 ///< a strip of a curved surface, which is no plane
  std::vector<ConvexPiece> pieces_m;  ///< disjoint; corners counter-clockwise seen from the free side
};

/// Area of a planar polygon, square metres.
double area_m2(const ConvexPiece& piece_m);
/// Area of all pieces of a surface, square metres; what furniture hides counts too.
double area_m2(const Surface& surface);

}  // namespace planemap::simulation

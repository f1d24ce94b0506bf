#pragma once

#include <Eigen/Geometry>
#include <planemap/simulation/surface.hpp>
#include <string>
#include <utility>
#include <vector>

#include "footprint.hpp"

namespace planemap::simulation {

constexpr double kTableTopM = 0.04;  ///< thickness

/// Which faces of a box can be seen; sides as the footprint's own axes.
struct BoxFaces {
  bool low_x = true;
  bool high_x = true;
  bool low_y = true;
  bool high_y = true;
  bool top = true;
};

/// Makes surfaces in the world of shapes in the scene's frame.
class SurfaceBuilder {
 public:
  explicit SurfaceBuilder(const Eigen::Isometry3d& T_world_scene) : T_world_scene_(T_world_scene) {}

  /// A surface with pieces in one plane, in any order of their corners.
  /// @param normal  towards the free side, unit, scene's frame
  void add(const std::string& name, PlaneClass plane_class, const Eigen::Vector3d& normal,
           const std::vector<ConvexPiece>& pieces_m);

  /// The sides of a box from bottom to top, and its top, each a surface of its own.
  void add_box(const std::string& name, const Footprint& footprint, double bottom_m, double top_m,
               const BoxFaces& faces, PlaneClass top_class);

  /// A round column, of facets; each is off the circle by 0.4 % of the radius at most.
  void add_column(const std::string& name, const Eigen::Vector2d& centre_m, double radius_m, double bottom_m,
                  double top_m);

  /// A table's top and its four legs.
  void add_table(const std::string& name, const Footprint& footprint, double top_m);

  std::vector<Surface> take() { return std::move(surfaces_); }

 private:
  Eigen::Isometry3d T_world_scene_;
  std::vector<Surface> surfaces_;
};

/// A rectangle on the floor, lifted.
ConvexPiece level_piece(const Footprint& footprint, double height_m);
/// An upright rectangle over a line on the floor.
ConvexPiece upright_piece(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double bottom_m, double top_m);

}  // namespace planemap::simulation

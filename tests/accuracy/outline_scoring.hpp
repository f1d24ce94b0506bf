#pragma once

#include <cstddef>
#include <planemap/outline.hpp>
#include <planemap/snapshot.hpp>
#include <vector>

#include "seen_surfaces.hpp"

namespace planemap::accuracy {

/// The outline of a plane beside what was seen of its surface. What was seen is a raster, gaps of up to a cell closed:
/// rays are farther apart than its squares where a surface was seen from afar, and outlines close such gaps, too.
struct OutlineScore {
  double seen_m2 = 0.0;       ///< of the seen squares, as far as they are on the surface
  double seen_width_m = 0.0;  ///< of the uniform rectangle that spreads as the seen squares do: the shorter side
  double outline_m2 = 0.0;    ///< of the polygons, less their holes
  /// How far the polygons reach beyond what was seen: for each square whose middle is in them, the distance from there
  /// to the nearest seen square's middle; 0 where it was seen.
  std::vector<double> overreach_m;
  /// How far they fall short of it: for each seen square on the surface, the distance from its middle to the polygons;
  /// 0 where it is in them.
  std::vector<double> shortfall_m;
  /// From points of the polygons' borders, holes too, to the nearest border of what was seen, of gaps that are closed
  /// too: a gap of about a cell may be there in one and not in the other.
  std::vector<double> border_m;

  /// Of the area, as a share of what was seen: positive where the outline is too large.
  double area_error() const { return seen_m2 > 0.0 ? outline_m2 / seen_m2 - 1.0 : 0.0; }
};

/// Virtual centres of the dense cells of a plane.
std::vector<Eigen::Vector3d> centres_of(const MapSnapshot& map, PlaneId plane);

/// @param surface  place in seen.surfaces(), of which something was seen
OutlineScore score_outline(const Outline& outline, const SeenSurfaces& seen, std::size_t surface);

}  // namespace planemap::accuracy

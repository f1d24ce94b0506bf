#pragma once

#include <cstddef>
#include <planemap/snapshot.hpp>
#include <vector>

#include "seen_surfaces.hpp"

namespace planemap::accuracy {

/// A plane of one map beside the plane of another map that shares most cells with it.
struct PlanePair {
  PlaneId plane = kNoPlane;
  std::size_t cells = 0;        ///< of the plane
  double width_m = 0.0;         ///< of the uniform rectangle whose points spread as the plane's do
  double tilt_sigma_deg = 0.0;  ///< standard error of its normal in the worst direction, as it states it
  PlaneId partner = kNoPlane;   ///< kNoPlane: no plane of the other map shares a cell
  std::size_t partner_cells = 0;
  std::size_t shared_cells = 0;
  double shared_surface = 0.0;  ///< overlap of what they hold of the seen surfaces, both ways
  // Empty of meaning without a partner:
  double angle_deg = 0.0;  ///< between the normals
  double offset_m = 0.0;   ///< of the partner from the plane's centroid

  /// Share of the plane's cells that are its partner's, or of the partner's that are the plane's: the lesser. Less than
  /// their surfaces overlap where cells hold more than one surface, or the noise of far looks.
  double shared_cell_share() const;
};

/// When two planes are the same one. Overlap is that of surfaces, as in the score.
struct SamePlaneBounds {
  double overlap = 0.8;
  double angle_deg = 0.1;
  double offset_m = 0.002;

  bool hold(const PlanePair& pair) const {
    return pair.shared_surface >= overlap && pair.angle_deg <= angle_deg && pair.offset_m <= offset_m;
  }
};

/// Every plane of a map that has the least number of dense cells, by id, with its partner in another map of the same
/// world and cell size. Cells are the same if they are at the same place in the grid.
/// @param seen  of the world, by which planes share surfaces
std::vector<PlanePair> pair_planes(const MapSnapshot& map, const MapSnapshot& other, const SeenSurfaces& seen,
                                   std::size_t least_cells);

}  // namespace planemap::accuracy

#pragma once

#include <cstddef>
#include <planemap/simulation/surface.hpp>
#include <vector>

namespace planemap::accuracy {

/// Surfaces that touch and differ by less are one surface to any mapper: a Kinect's own steps of depth are 2.8 mm at
/// 1 m, and planes of cells are never known better than that over a hand's breadth.
constexpr double kResolvedAngle_deg = 1.0;
constexpr double kResolvedOffset_m = 0.002;  ///< of each corner of the smaller one from the plane of the larger one
/// Pieces with a smaller gap touch: half a cell of the default size, a square of the raster of what was seen.
constexpr double kTouchingGap_m = 0.04;

/// Whether two surfaces touch, face the same way within kResolvedAngle_deg, and the smaller one lies within
/// kResolvedOffset_m of the larger one's plane. Facets of curved surfaces never do.
bool are_one_surface(const simulation::Surface& a, const simulation::Surface& b);

/// For each surface, the place of the one that it counts as part of: its own, or that of the largest surface that it
/// cannot be told from. A surface that is part of another has no parts itself: surfaces that differ step by step don't
/// become one.
std::vector<std::size_t> joined_surfaces(const std::vector<simulation::Surface>& surfaces);

}  // namespace planemap::accuracy

#pragma once

#include <Eigen/Core>
#include <planemap/cell.hpp>
#include <planemap/plane.hpp>

namespace planemap {

/// Noise of more than this share of a cell's edge spreads a surface over several layers of cells.
constexpr double kLayeredShare = 0.25;

/// A cell's own points tell a normal where they spread by this share of its edge at least: a strip turns freely about
/// its length.
constexpr double kLeastPatchSpread = 0.15;

/// Mean square distance to a plane, square metres, of the noise that a cell holds of it: all of it where the plane
/// passes through the middle of the cell, its tail in the outer layers of what noise spreads over several cells. The
/// second moment of a normal distribution between the cell's faces.
/// @param centre_m     signed distance of the cell's centre from the plane
/// @param variance_m2  of the points along the plane's normal
double expected_scatter_m2(double centre_m, double cell_size_m, double variance_m2);

/// Whether noise of that variance spreads points over several layers of cells: then the mean of a cell's points says
/// little of where their surface is.
bool is_layered(double variance_m2, double cell_size_m);

/// Whether the mean of a cell's evidence surely lies off a plane. False where the noise spreads over several cells.
bool lies_aside(const Cell& cell, const Eigen::Vector3d& centre_m, const Plane& plane, double cell_size_m);

}  // namespace planemap

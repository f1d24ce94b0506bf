#pragma once

#include <Eigen/Core>
#include <planemap/outline.hpp>
#include <span>
#include <vector>

namespace planemap {

/// The points with normal . x <= offset_m. The normal may have any length, also 0: then it holds all points or none.
struct HalfPlane {
  Eigen::Vector2d normal;
  double offset_m = 0.0;

  double excess(const Eigen::Vector2d& p_m) const { return normal.dot(p_m) - offset_m; }
};

/// All rings of polygons: outer ones counter-clockwise, holes clockwise.
std::vector<Ring> rings_of(std::span<const Polygon> polygons);
/// Whether all of the rings is in the half-plane.
bool holds(const HalfPlane& half_plane, const std::vector<Ring>& rings);
/// What of the rings' inside is in the half-plane. Their inside is to the left of each side, before and after.
void clip(std::vector<Ring>& rings, const HalfPlane& half_plane);
/// Puts rings together: each hole into the smallest outer ring around it, largest polygon first. Slivers of less than a
/// square micrometre are left out.
std::vector<Polygon> polygons_of(std::vector<Ring> rings);

}  // namespace planemap

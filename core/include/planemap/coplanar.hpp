#pragma once

#include <cstddef>
#include <map>
#include <planemap/plane.hpp>
#include <planemap/snapshot.hpp>
#include <span>
#include <vector>

namespace planemap {

/// A plane and how much of it there is.
struct SizedPlane {
  const PlaneRecord* record = nullptr;
  double area_m2 = 0.0;
};

/// Smaller planes are linked with none: too many of them agree with something by chance.
constexpr double kLeastLinkedAreaM2 = 0.25;

/// Whether two planes that face the same way have the same parameters, as far as is known. They are compared by what a
/// reader would see of a difference: the distances between them at their centroids (at least 1 m apart: a nearer look
/// shows no tilt) and the turn about the line through these. The three must be within the 95 % of what both covariances
/// and 5 mm and 0.5 degrees allow, so that exact planes agree up to 1 cm, as where pieces are bridged. Where they are
/// known worse than to 2 cm and 1.5 degrees nobody can tell, and the answer is no. Errors that the two share, as those
/// of the poses that saw both, are not known to be shared: they allow a difference that they did not make.
bool are_coplanar(const PlaneRecord& a, const PlaneRecord& b);

/// For each plane that has any: the other planes that are coplanar with it, ascending. A link goes both ways, but it is
/// not handed on: of three planes in a row the outer two may differ by more than either from the middle one.
using CoplanarLinks = std::map<PlaneId, std::vector<PlaneId>>;

/// Searches by normal and distance: planes of other directions, or far from each other along theirs, cost nothing.
CoplanarLinks coplanar_links(std::span<const SizedPlane> planes);
/// The same for a map; the size of a plane by its cells.
CoplanarLinks coplanar_links(const MapSnapshot& snapshot);
/// The links of one of the planes alone, ascending: what coplanar_links() has for it.
/// @param plane  place in `planes`
std::vector<PlaneId> coplanar_with(std::span<const SizedPlane> planes, std::size_t plane);

}  // namespace planemap

#pragma once

#include <cstddef>
#include <planemap/outline.hpp>
#include <planemap/plane.hpp>
#include <planemap/snapshot.hpp>
#include <planemap_lcm/cell_t.hpp>
#include <planemap_lcm/plan_polygon_t.hpp>
#include <planemap_lcm/plane_t.hpp>
#include <planemap_lcm/polygon_t.hpp>
#include <planemap_lcm/region_plane_t.hpp>
#include <planemap_lcm/removed_plane_t.hpp>

namespace planemap::service {

planemap_lcm::plane_t to_wire(const PlaneRecord& record, const Outline& outline, PlaneClass plane_class);
planemap_lcm::polygon_t to_wire(const Polygon& polygon);
planemap_lcm::cell_t to_wire(const CellView& cell);
planemap_lcm::removed_plane_t to_wire(const RemovedPlane& removed);

/// Makes a plane's boundary coarser until the plane, encoded within a message, takes at most max_bytes. Each step
/// doubles the tolerance; rings that vanish are left out, and at the last the smallest pieces. Area and all other
/// fields stay.
/// @param cell_size_m  the boundary comes simplified to a quarter of it
/// @return whether something had to be changed
bool simplify_to_fit(planemap_lcm::plane_t& plane, std::size_t max_bytes, double cell_size_m);
/// The same; boundary and clipped polygons share the room.
bool simplify_to_fit(planemap_lcm::region_plane_t& plane, std::size_t max_bytes, double cell_size_m);
/// The same for a single polygon, which stays too large where it would vanish.
bool simplify_to_fit(planemap_lcm::plan_polygon_t& polygon, std::size_t max_bytes, double cell_size_m);

}  // namespace planemap::service

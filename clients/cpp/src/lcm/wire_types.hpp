#pragma once

#include <planemap/client/map_types.hpp>
#include <planemap_lcm/cell_t.hpp>
#include <planemap_lcm/plane_t.hpp>
#include <planemap_lcm/polygon_t.hpp>
#include <planemap_lcm/status_t.hpp>

namespace planemap::client {

// From the wire to plain types. @pre the message was found sound when it was decoded

Vector3 vector3_of(const double (&values)[3]);
Polygon polygon_of(const planemap_lcm::polygon_t& wire);
Plane plane_of(const planemap_lcm::plane_t& wire);
Cell cell_of(const planemap_lcm::cell_t& wire);
Status status_of(const planemap_lcm::status_t& wire);

}  // namespace planemap::client

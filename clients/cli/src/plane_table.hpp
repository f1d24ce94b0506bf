#pragma once

#include <string>

#include "export/export_map.hpp"

namespace planemap::cli {

/// The planes as a table for people, largest first: id, class, cells, points, area, normal and its standard error,
/// distance from the world's origin, the standard error of the plane's offset at its centroid, and coplanar planes.
std::string plane_table(const ExportMap& map);

/// Standard error of where the plane is, at its centroid along its normal, metres.
double offset_sigma_m(const PlaneRecord& plane);

/// Standard error of the normal's direction: its largest, over all directions in which it may tilt, radians.
double normal_sigma_rad(const PlaneRecord& plane);

}  // namespace planemap::cli

#pragma once

#include <ostream>
#include <string>

#include "export/export_map.hpp"

namespace planemap {

/// planes.json: frame, epoch, revision and all planes with their boundaries in the world frame. Numbers are written so
/// that reading gives the same doubles.
void write_planes_json(const ExportMap& map, std::ostream& out);

/// One plane of planes.json, on one line.
std::string plane_json(const ExportPlane& plane);

/// cells.csv: one row for each dense cell; the normal's columns are empty where it is not known.
void write_cells_csv(const ExportMap& map, std::ostream& out);

/// planes.ply: each plane as a mesh of its boundaries, coloured by plane; binary, little endian.
void write_planes_ply(const ExportMap& map, std::ostream& out);

/// planes.obj: each plane as an object with a colour of its own.
void write_planes_obj(const ExportMap& map, std::ostream& out);

/// Floor plan: the planes seen from above.
void write_floor_plan_svg(const ExportMap& map, std::ostream& out);

}  // namespace planemap

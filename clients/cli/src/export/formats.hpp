#pragma once

#include <filesystem>
#include <ostream>
#include <planemap/expected.hpp>

#include "export/export_map.hpp"

namespace planemap::cli {

/// planes.json: frame, epoch, revision and all planes with their boundaries in the world frame. Numbers are written so
/// that reading gives the same doubles.
void write_planes_json(const ExportMap& map, std::ostream& out);

/// cells.csv: one row for each dense cell; the normal's columns are empty where it is not known.
void write_cells_csv(const ExportMap& map, std::ostream& out);

/// Dense cells as points with normals, coloured by their plane, grey without one. Binary PLY, through PCL.
Expected<void> write_cells_ply(const ExportMap& map, const std::filesystem::path& path);

/// Floor plan: the planes seen from above.
void write_floor_plan_svg(const ExportMap& map, std::ostream& out);

}  // namespace planemap::cli

#pragma once

#include <filesystem>
#include <planemap/expected.hpp>

#include "export/export_map.hpp"

namespace planemap::cli {

/// Dense cells as points with normals, coloured by their plane, grey without one. Binary PLY, through PCL.
Expected<void> write_cells_ply(const ExportMap& map, const std::filesystem::path& path);

}  // namespace planemap::cli

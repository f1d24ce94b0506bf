#pragma once

#include <filesystem>
#include <planemap/expected.hpp>
#include <planemap/simulation/surface.hpp>
#include <span>
#include <string>

namespace planemap::simulation {

/// The surfaces in the schema of planes.json (metres, radians, square metres), with the name of each besides. A plane's
/// polygons are its convex pieces; its covariance and counts are 0. Facets of
/// curved surfaces are left out: they are no planes.
std::string truth_json(std::span<const Surface> surfaces);

/// Writes truth_json() to a file, whole or not at all.
Expected<void> write_truth_file(std::span<const Surface> surfaces, const std::filesystem::path& path);

}  // namespace planemap::simulation

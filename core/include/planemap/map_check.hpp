#pragma once

#include <planemap/config.hpp>
#include <planemap/expected.hpp>
#include <planemap/snapshot.hpp>

namespace planemap {

/// Whether a mapper with that configuration can go on with a map that comes from outside; the error says what is wrong
/// with it, and where.
Expected<void> check_map(const MapperConfig& config, const MapSnapshot& map);

}  // namespace planemap

#pragma once

#include <planemap/client/map_types.hpp>
#include <planemap/expected.hpp>

#include "export/export_map.hpp"

namespace planemap::cli {

/// From a service's answer. Which way is down is taken from its floors, tables and ceilings.
Expected<ExportMap> export_map_of(const client::Map& wire);

}  // namespace planemap::cli

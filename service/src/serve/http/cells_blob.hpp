#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "serve/http/map_sheet.hpp"

namespace planemap::service {

/// Dense cells as browsers take them: blocks that replace those of the same index, little endian (docs/http.md).
/// @param since  revision of the sheet that the reader has the blocks of; empty, unknown or from before what is known:
///               all blocks
std::string cells_blob(const MapSheet& sheet, std::optional<std::uint64_t> since);

}  // namespace planemap::service

#pragma once

#include <memory>
#include <planemap/expected.hpp>
#include <planemap/plane.hpp>
#include <span>

#include "common/byte_stream.hpp"

namespace planemap::service {

/// A plane's record and what the mapper knows of it, to the bit (docs/map_file.md). @pre record.state
Bytes encode_plane(const PlaneRecord& record);
Expected<std::shared_ptr<const PlaneRecord>> decode_plane(PlaneId id, std::span<const std::uint8_t> bytes);

}  // namespace planemap::service

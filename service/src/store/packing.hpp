#pragma once

#include <cstdint>
#include <planemap/expected.hpp>
#include <span>

#include "common/byte_stream.hpp"

namespace planemap::service {

/// Compressed bytes: their size as 32 bits, then zlib's.
/// @throws std::runtime_error where zlib has no memory
Bytes packed(std::span<const std::uint8_t> raw);
/// @param most  greatest size that is taken, looked at before memory is
Expected<Bytes> unpacked(std::span<const std::uint8_t> bytes, std::size_t most);

}  // namespace planemap::service

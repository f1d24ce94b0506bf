#pragma once

#include <cstdint>
#include <memory>
#include <planemap/block.hpp>
#include <planemap/expected.hpp>
#include <span>

#include "common/byte_stream.hpp"

namespace planemap::service {

/// The cells of a block as bytes (docs/map_file.md). The evidence of planes, the counts, the labels and the shares of
/// the evidence are kept to the bit, first moments to a float's digits; second moments about the axes, errors and views
/// to 1/256, normals to 1/10000, their deviations to 1/256. What was decoded is encoded to the same bytes.
Bytes encode_block(const Block& block);

/// @param index  of the block
/// @return fails where the bytes are none of encode_block()'s; whether the cells make sense is check_map()'s to say
Expected<std::shared_ptr<Block>> decode_block(const BlockIndex& index, std::span<const std::uint8_t> bytes);

}  // namespace planemap::service

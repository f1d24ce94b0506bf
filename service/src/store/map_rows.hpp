#pragma once

#include <cstdint>
#include <map>
#include <planemap/block.hpp>
#include <planemap/snapshot.hpp>
#include <span>
#include <string>

namespace planemap::service {

// What the checksums of a map file are made of: zlib's crc32.

std::uint32_t block_checksum(std::int64_t slot, const BlockIndex& index, std::size_t cells,
                             std::span<const std::uint8_t> bytes);
std::uint32_t plane_checksum(PlaneId id, std::span<const std::uint8_t> bytes);
std::uint32_t removed_checksum(const RemovedPlane& removed);

/// Rows of the table meta, by key.
using FactRows = std::map<std::string, std::string>;
/// Of all rows but "checksum" itself.
std::string facts_checksum(const FactRows& facts);

/// A number that text keeps to the bit.
std::string text_of(double number);

}  // namespace planemap::service

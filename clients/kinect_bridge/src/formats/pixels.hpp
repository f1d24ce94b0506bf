#pragma once

#include <cstdint>
#include <planemap/scan.hpp>
#include <vector>

namespace planemap::kinect_bridge {

/// Depths in millimetres, 0 where nothing was seen or what was is beyond 65534 mm.
std::vector<std::uint16_t> millimetres(const DepthScan& scan);
std::vector<std::uint8_t> little_endian(const std::vector<std::uint16_t>& pixels);
void append_little_endian(std::vector<std::uint8_t>& bytes, std::uint32_t word);
/// Through zlib, level 1. Throws std::runtime_error if zlib can't.
std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& raw);
/// A 16-bit grey PNG. Throws std::runtime_error if libpng can't.
std::vector<std::uint8_t> png_of(const std::vector<std::uint16_t>& pixels, int width, int height);

}  // namespace planemap::kinect_bridge

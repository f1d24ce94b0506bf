#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/rejection.hpp"

namespace planemap::service {

/// Reads a 16-bit grey PNG of exactly that size; memory is taken for the pixels once its header has been found to say
/// so. Reason of what it rejects: encoding.
/// @param type  of the message, for errors
Decoded<std::vector<std::uint16_t>> read_png(const char* type, std::span<const std::uint8_t> data, std::int32_t width,
                                             std::int32_t height);

}  // namespace planemap::service

#pragma once

#include "codec/scan_codec.hpp"
#include "fuzz_input.hpp"

namespace planemap::fuzz {

/// limits.image_bytes of these targets.
constexpr std::size_t kImageBytes = std::size_t{64} << 10;

/// How messages of a type are packed.
enum class Packing { kRaw, kMaybeCompressed };

/// Decodes a scan within its memory, and maps what was taken: nothing that passes the decoder may hurt the mapper.
void decode_and_map(const Bytes& message, Packing packing, const service::ScanFormat& format = {});

/// A format that says all that messages may leave out.
service::ScanFormat full_format();

}  // namespace planemap::fuzz

#pragma once

#include <cstddef>
#include <cstdint>
#include <planemap/scan.hpp>
#include <span>
#include <string>

#include "codec/fingerprint.hpp"
#include "codec/rejection.hpp"
#include "codec/scan_format.hpp"

namespace planemap::service {

/// A scan as it came off the wire.
struct DecodedScan {
  Scan scan;
  std::int32_t seq = 0;  ///< of the sensor; grows by one; -1 where the type has none
};

/// Decodes a scan of any family, told apart by the fingerprint. Everything is checked before memory is taken for it; no
/// message makes this take more than twice max_bytes and a bit.
/// @param max_bytes  greatest image or cloud after decompression
/// @param format     what the message does not say itself, and which family is wanted
Decoded<DecodedScan> decode_scan(std::span<const std::uint8_t> message, std::size_t max_bytes,
                                 const ScanFormat& format = {});

}  // namespace planemap::service

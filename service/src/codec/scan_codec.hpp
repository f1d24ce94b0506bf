#pragma once

#include <cstddef>
#include <cstdint>
#include <planemap/expected.hpp>
#include <planemap/scan.hpp>
#include <span>
#include <string>

namespace planemap::service {

/// A scan as it came off the wire.
struct DecodedScan {
  Scan scan;
  std::int32_t seq = 0;  ///< of the sensor; grows by one
};

/// Why a message could not be used: a word for the counter and a sentence for the log.
struct Rejection {
  std::string reason;   ///< unknown_type, truncated, size, checksum, ...
  std::string message;  ///< what and where, with numbers
};

template <class T>
using Decoded = tl::expected<T, Rejection>;

/// The first 8 bytes of an LCM message, which name its type; 0 if it is shorter.
std::uint64_t fingerprint_of(std::span<const std::uint8_t> message);
/// "0x2e16efb052b0105e"
std::string fingerprint_text(std::uint64_t fingerprint);

/// Decodes planemap_lcm.depth_scan_t or point_scan_t, told apart by the fingerprint. Everything is checked before
/// memory is taken for it; no message makes this take more than max_bytes and a bit.
/// @param max_bytes  greatest image or cloud after decompression
Decoded<DecodedScan> decode_scan(std::span<const std::uint8_t> message, std::size_t max_bytes);

}  // namespace planemap::service

#pragma once

#include <cstddef>
#include <cstdint>
#include <planemap/scan.hpp>
#include <span>
#include <vector>

#include "codec/scan_codec.hpp"

namespace planemap::service {

/// How an image's bytes are packed.
enum class Packing { kRaw, kZlib, kPng };
/// What a pixel is.
enum class PixelKind { kUint16, kFloat32 };

constexpr std::size_t size_of(PixelKind kind) {
  return kind == PixelKind::kUint16 ? 2 : 4;
}

/// A depth image as a message describes it; nothing is checked yet.
struct WireImage {
  const char* type = "";  ///< of the message, for errors
  std::int64_t utime = 0;
  std::int32_t seq = -1;
  std::int32_t width = 0;       ///< pixels
  std::int32_t height = 0;      ///< pixels
  std::int32_t row_stride = 0;  ///< bytes from a row to the next, before compression
  Packing packing = Packing::kRaw;
  PixelKind pixels = PixelKind::kUint16;
  bool is_big_endian = false;
  double unit_m = 0.001;  ///< of 16-bit pixels; floats are metres
  std::span<const std::uint8_t> data;
};

/// Checks it against the limits and makes a scan of it. Floats are rounded to format.depth_unit_m; those that are not
/// finite, not above 0 or beyond 65534 units are no returns.
Decoded<DecodedScan> to_depth_scan(const WireImage& image, const ScanFormat& format, std::size_t max_bytes);

// The steps of it, for types that need others in between.

/// Checks time and size of an image and gives a scan of format's intrinsics, without pixels.
/// @param image_bytes  what is to be taken for the pixels, after decompression
Decoded<DepthScan> scan_of(const WireImage& image, std::size_t image_bytes, const ScanFormat& format,
                           std::size_t max_bytes);
/// Checks that an image of the intrinsics looks less than 89 degrees to the side, so that its points stay within the
/// grid's integers.
Decoded<void> check_intrinsics(const char* type, const PinholeIntrinsics& camera);
/// Checks 1 to 4096 pixels each, and image_bytes against the limit.
Decoded<void> check_image_size(const char* type, std::int32_t width, std::int32_t height, std::size_t image_bytes,
                               std::size_t max_bytes);
/// Decompresses into exactly `out`; the stream has to end with its last byte.
Decoded<void> inflate_exactly(const char* type, std::span<const std::uint8_t> data, std::span<std::uint8_t> out);
/// Checks that an image's pixels could be packed so densely, before memory is taken for them.
/// @param packing  "zlib" or "PNG"
Decoded<void> check_packed_size(const char* type, const char* packing, std::size_t packed_bytes, std::int32_t width,
                                std::int32_t height, std::size_t image_bytes);

}  // namespace planemap::service

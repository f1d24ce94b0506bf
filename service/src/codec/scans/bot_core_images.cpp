// bot_core.images_t and image_t.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bot_core/image_t.hpp>
#include <bot_core/images_t.hpp>
#include <span>
#include <vector>

#include "codec/scans/depth_image.hpp"
#include "codec/scans/families.hpp"

namespace planemap::service {
namespace {

using bot_core::image_t;
using bot_core::images_t;

constexpr std::size_t kLeastImageBytes = 8 + 6 * 4;  // of an image_t without data and metadata
constexpr std::size_t kMaxImages = 1000;
constexpr std::size_t kLeastMetadataBytes = 4 + 1 + 4;

/// An image_t as it stands on the wire.
struct BotImage {
  WireImage image;
  std::int32_t pixel_format = 0;
};

BotImage read_image(WireReader& reader, const char* type) {
  BotImage read;
  read.image.type = type;
  read.image.utime = reader.i64();
  read.image.width = reader.i32();
  read.image.height = reader.i32();
  read.image.row_stride = reader.i32();
  read.pixel_format = reader.i32();
  read.image.data = reader.bytes(reader.count(1));
  for (std::size_t left = reader.count(kLeastMetadataBytes); left > 0 && reader.ok(); --left) {
    reader.text();
    reader.bytes(reader.count(1));
  }
  return read;
}

}  // namespace

Decoded<DecodedScan> decode_images(WireReader reader, const ScanFormat& format, std::size_t max_bytes) {
  constexpr const char* kType = "images_t";
  const std::int64_t utime = reader.i64();
  const std::size_t count = reader.count(2 + kLeastImageBytes);
  if (count > kMaxImages) {
    return reject("size", fmt::format("{}: n_images is {} (allowed: up to {})", kType, count, kMaxImages));
  }
  std::vector<std::int16_t> kinds(count);
  for (std::int16_t& kind : kinds) kind = reader.i16();
  WireImage depth;
  for (const std::int16_t kind : kinds) {
    if (!reader.ok()) break;
    const BotImage read = read_image(reader, kType);
    const bool is_zipped = kind == images_t::DEPTH_MM_ZIPPED;
    if ((kind != images_t::DEPTH_MM && !is_zipped) || depth.type == kType) continue;
    // The pixel format is left as it was before zipping, by some as they please: the kind says what it is.
    depth = read.image;
    depth.packing = is_zipped ? Packing::kZlib : Packing::kRaw;
  }
  if (const auto end = check_end(reader, kType); !end) return tl::make_unexpected(end.error());
  if (depth.type != kType) {
    return reject("no_depth",
                  fmt::format("{}: of {} images none is depth; their image_types are [{}] (taken: 4 "
                              "DEPTH_MM, 6 DEPTH_MM_ZIPPED)",
                              kType, count, fmt::join(std::span(kinds).first(std::min<std::size_t>(count, 8)), ", ")));
  }
  if (depth.utime == 0) depth.utime = utime;
  return to_depth_scan(depth, format, max_bytes);
}

Decoded<DecodedScan> decode_image(WireReader reader, const ScanFormat& format, std::size_t max_bytes) {
  constexpr const char* kType = "image_t";
  BotImage read = read_image(reader, kType);
  if (const auto end = check_end(reader, kType); !end) return tl::make_unexpected(end.error());
  read.image.is_big_endian = read.pixel_format == image_t::PIXEL_FORMAT_BE_GRAY16;
  if (!read.image.is_big_endian && read.pixel_format != image_t::PIXEL_FORMAT_LE_GRAY16) {
    return reject("format", fmt::format("{}: pixelformat is {}, no 16-bit grey (allowed: {} little-endian, {} "
                                        "big-endian)",
                                        kType, read.pixel_format, image_t::PIXEL_FORMAT_LE_GRAY16,
                                        image_t::PIXEL_FORMAT_BE_GRAY16));
  }
  read.image.unit_m = format.depth_unit_m;
  return to_depth_scan(read.image, format, max_bytes);
}

}  // namespace planemap::service

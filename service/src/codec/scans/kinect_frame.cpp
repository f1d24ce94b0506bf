// kinect.frame_msg_t.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <kinect/depth_msg_t.hpp>
#include <vector>

#include "codec/scans/depth_image.hpp"
#include "codec/scans/families.hpp"

namespace planemap::service {
namespace {

using kinect::depth_msg_t;

constexpr const char* kType = "frame_msg_t";
constexpr std::size_t kTailBytes = 3 * 2 + 1 + 3 * 8 + 8 + 1 + 1;  // accelerations, tilt, LED

/// The depth_msg_t of a frame.
struct KinectDepth {
  std::int64_t utime = 0;
  std::int16_t width = 0;
  std::int16_t height = 0;
  std::span<const std::uint8_t> data;
  std::int8_t format = 0;
  std::int8_t compression = 0;
  std::int32_t uncompressed_size = 0;
};

Decoded<KinectDepth> read_frame(WireReader& reader) {
  reader.bytes(8 + 8 + 2 + 2);  // time of sending; time, width and height of the colour image
  reader.bytes(reader.count(1));
  reader.i8();
  KinectDepth depth;
  depth.utime = reader.i64();
  depth.width = reader.i16();
  depth.height = reader.i16();
  depth.data = reader.bytes(reader.count(1));
  depth.format = reader.i8();
  depth.compression = reader.i8();
  depth.uncompressed_size = reader.i32();
  reader.bytes(kTailBytes);
  if (const auto end = check_end(reader, kType); !end) return tl::make_unexpected(end.error());
  return depth;
}

/// How a depth format is laid out.
struct FormatInfo {
  std::int8_t format;
  int bits;  ///< of a disparity; 0: millimetres
  bool may_be_packed;
};
constexpr FormatInfo kFormats[] = {
    {depth_msg_t::DEPTH_11BIT, 11, false},       {depth_msg_t::DEPTH_10BIT, 10, false},
    {depth_msg_t::DEPTH_11BIT_PACKED, 11, true}, {depth_msg_t::DEPTH_10BIT_PACKED, 10, true},
    {depth_msg_t::DEPTH_REGISTERED, 0, false},   {depth_msg_t::DEPTH_MM, 0, false},
};

Decoded<FormatInfo> format_info(std::int8_t format) {
  for (const FormatInfo& info : kFormats) {
    if (info.format == format) return info;
  }
  if (format == depth_msg_t::DEPTH_NONE) {
    return reject("no_depth", fmt::format("{}: depth_data_format is 10: the driver sends no depth", kType));
  }
  return reject("format", fmt::format("{}: depth_data_format is {} (allowed: 0 to 5)", kType, format));
}

/// Bytes of the depth image without compression. The libfreenect driver unpacks packed formats to 16 bits and leaves
/// the format as it was, so it is the length that tells.
Decoded<std::size_t> image_bytes(const KinectDepth& depth, std::size_t pixels, const FormatInfo& info) {
  const std::size_t whole = 2 * pixels;
  const std::size_t packed = (pixels * static_cast<std::size_t>(info.bits) + 7) / 8;
  const bool is_raw = depth.compression == depth_msg_t::COMPRESSION_NONE;
  if (!is_raw && depth.compression != depth_msg_t::COMPRESSION_ZLIB) {
    return reject("encoding", fmt::format("{}: compression is {} (allowed: 0 none, 1 zlib)", kType, depth.compression));
  }
  const auto said = is_raw ? depth.data.size() : static_cast<std::size_t>(std::max(depth.uncompressed_size, 0));
  if (said == whole || (info.may_be_packed && said == packed)) return said;
  return reject("size", fmt::format("{}: {} is {} for {} x {} pixels, must be {}{}", kType,
                                    is_raw ? "depth_data_nbytes" : "uncompressed_size", said, depth.width, depth.height,
                                    whole, info.may_be_packed ? fmt::format(" or {} (packed)", packed) : ""));
}

/// Pixels of `bits` bits each, the most significant first.
void unpack_bits(std::span<const std::uint8_t> packed, int bits, std::vector<std::uint16_t>& pixels) {
  std::uint32_t buffer = 0;
  int held = 0;
  std::size_t next = 0;
  for (std::uint16_t& pixel : pixels) {
    for (; held < bits; held += 8) buffer = (buffer << 8U) | packed[next++];
    held -= bits;
    pixel = static_cast<std::uint16_t>((buffer >> held) & ((1U << bits) - 1));
  }
}

/// Disparities to depths in units; what saw nothing (all bits set) or lies beyond the units' reach is no return.
Decoded<void> disparity_to_depth(int bits, const ScanFormat& format, DepthScan& scan) {
  if (!format.disparity) {
    return reject("disparity", fmt::format("{}: depth is raw {}-bit disparity: set inputs[].disparity to [baseline in "
                                           "metres, offset], for instance [0.075, 1090]",
                                           kType, bits));
  }
  scan.depth_scale_m = format.depth_unit_m;
  const auto count = std::size_t{1} << static_cast<unsigned>(bits);
  std::vector<std::uint16_t> depths(count, kNoReturn);
  const double numerator = 8.0 * scan.intrinsics.fx * format.disparity->baseline_m / scan.depth_scale_m;
  for (std::size_t d = 0; d + 1 < count; ++d) {
    const double below = format.disparity->offset - static_cast<double>(d);
    const double units = below > 0.0 ? std::nearbyint(numerator / below) : 0.0;
    if (units < kNoReturnHigh) depths[d] = static_cast<std::uint16_t>(units);
  }
  for (std::uint16_t& pixel : scan.depth) pixel = pixel < count ? depths[pixel] : kNoReturn;
  return {};
}

}  // namespace

Decoded<DecodedScan> decode_kinect_frame(WireReader reader, const ScanFormat& format, std::size_t max_bytes) {
  const auto depth = read_frame(reader);
  if (!depth) return tl::make_unexpected(depth.error());
  const auto info = format_info(depth->format);
  if (!info) return tl::make_unexpected(info.error());
  WireImage image;
  image.type = kType;
  image.utime = depth->utime;
  image.width = depth->width;
  image.height = depth->height;
  const std::size_t pixels = static_cast<std::size_t>(std::max<int>(depth->width, 0)) *
                             static_cast<std::size_t>(std::max<int>(depth->height, 0));
  auto scan = scan_of(image, 2 * pixels, format, max_bytes);
  if (!scan) return tl::make_unexpected(scan.error());
  const auto size = image_bytes(*depth, pixels, *info);
  if (!size) return tl::make_unexpected(size.error());
  std::span<const std::uint8_t> bytes = depth->data;
  std::vector<std::uint8_t> inflated;
  if (depth->compression == depth_msg_t::COMPRESSION_ZLIB) {
    const auto packed = check_packed_size(kType, "zlib", depth->data.size(), depth->width, depth->height, *size);
    if (!packed) return tl::make_unexpected(packed.error());
    inflated.resize(*size);
    if (const auto done = inflate_exactly(kType, depth->data, inflated); !done) {
      return tl::make_unexpected(done.error());
    }
    bytes = inflated;
  }
  scan->depth.resize(pixels);
  if (*size == 2 * pixels) {
    std::memcpy(scan->depth.data(), bytes.data(), *size);
  } else {
    unpack_bits(bytes, info->bits, scan->depth);
  }
  if (info->bits > 0) {
    if (const auto done = disparity_to_depth(info->bits, format, *scan); !done) {
      return tl::make_unexpected(done.error());
    }
  }
  return DecodedScan{std::move(*scan), -1};
}

}  // namespace planemap::service

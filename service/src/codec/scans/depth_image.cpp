#include "codec/scans/depth_image.hpp"

#include <spdlog/fmt/fmt.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "codec/scans/png_image.hpp"

namespace planemap::service {
namespace {

constexpr std::int32_t kMaxImageEdge = 4096;   // pixels; depth_scan_t.lcm
constexpr std::int32_t kMaxRowPadding = 4096;  // bytes behind the pixels of a row
constexpr std::size_t kMaxZlibRatio = 1032;    // deflate packs no denser
constexpr double kMaxSlope = 100.0;            // x/z of a pixel: 89.4 degrees; keeps points within the grid's integers

/// An image's rows, where they are.
struct Rows {
  std::span<const std::uint8_t> bytes;
  std::size_t stride;
};

Decoded<void> check_row_stride(const WireImage& image) {
  const std::int64_t row_bytes = std::int64_t{image.width} * static_cast<std::int64_t>(size_of(image.pixels));
  if (image.row_stride >= row_bytes && image.row_stride <= row_bytes + kMaxRowPadding) return {};
  return reject(
      "size", fmt::format("{}: row_stride is {} for {} pixels of {} bytes (allowed: {} to {})", image.type,
                          image.row_stride, image.width, size_of(image.pixels), row_bytes, row_bytes + kMaxRowPadding));
}

void copy_uint16(const Rows& rows, bool is_big_endian, DepthScan& scan) {
  const auto width = static_cast<std::size_t>(scan.intrinsics.width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(scan.intrinsics.height); ++v) {
    std::uint16_t* row = scan.depth.data() + v * width;
    std::memcpy(row, rows.bytes.data() + v * rows.stride, 2 * width);
    if (is_big_endian) std::transform(row, row + width, row, [](std::uint16_t x) { return __builtin_bswap16(x); });
  }
}

/// Metres to units; what is no depth, or beyond the units' reach, is no return.
std::uint16_t rounded(float z_m, double unit_m) {
  if (!std::isfinite(z_m) || z_m <= 0.0F) return kNoReturn;
  const double units = std::nearbyint(z_m / unit_m);
  return units >= kNoReturnHigh ? kNoReturn : static_cast<std::uint16_t>(units);
}

void copy_float32(const Rows& rows, bool is_big_endian, DepthScan& scan) {
  const auto width = static_cast<std::size_t>(scan.intrinsics.width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(scan.intrinsics.height); ++v) {
    for (std::size_t u = 0; u < width; ++u) {
      std::uint32_t word = 0;
      std::memcpy(&word, rows.bytes.data() + v * rows.stride + 4 * u, 4);
      if (is_big_endian) word = __builtin_bswap32(word);
      scan.depth[v * width + u] = rounded(std::bit_cast<float>(word), scan.depth_scale_m);
    }
  }
}

/// What fits no image of that size is refused before memory is taken for the image.
Decoded<void> check_data_size(const WireImage& image, std::size_t image_bytes) {
  if (image.packing == Packing::kRaw && image.data.size() != image_bytes) {
    return reject("size", fmt::format("{}: {} bytes of raw data for {} rows of {} bytes, must be {}", image.type,
                                      image.data.size(), image.height, image.row_stride, image_bytes));
  }
  if (image.packing == Packing::kRaw) return {};
  return check_packed_size(image.type, image.packing == Packing::kPng ? "PNG" : "zlib", image.data.size(), image.width,
                           image.height, image_bytes);
}

}  // namespace

Decoded<void> check_packed_size(const char* type, const char* packing, std::size_t packed_bytes, std::int32_t width,
                                std::int32_t height, std::size_t image_bytes) {
  if (packed_bytes * kMaxZlibRatio >= image_bytes) return {};
  return reject("size", fmt::format("{}: {} bytes of {} data cannot hold {} x {} pixels", type, packed_bytes, packing,
                                    width, height));
}

Decoded<void> check_image_size(const char* type, std::int32_t width, std::int32_t height, std::size_t image_bytes,
                               std::size_t max_bytes) {
  if (width < 1 || width > kMaxImageEdge || height < 1 || height > kMaxImageEdge) {
    return reject("size",
                  fmt::format("{}: {} x {} pixels (allowed: 1 to {} each)", type, width, height, kMaxImageEdge));
  }
  if (image_bytes > max_bytes) {
    return reject("too_large", fmt::format("{}: {} x {} pixels are {} bytes, limits.image_bytes is {}", type, width,
                                           height, image_bytes, max_bytes));
  }
  return {};
}

Decoded<void> check_intrinsics(const char* type, const PinholeIntrinsics& camera) {
  const auto is_positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!is_positive(camera.fx) || !is_positive(camera.fy) || !std::isfinite(camera.cx) || !std::isfinite(camera.cy)) {
    return reject("intrinsics", fmt::format("{}: fx {} fy {} cx {} cy {} (allowed: finite, fx and fy > 0)", type,
                                            camera.fx, camera.fy, camera.cx, camera.cy));
  }
  const double slope_x = std::max(std::abs(camera.cx), std::abs(camera.width - camera.cx)) / camera.fx;
  const double slope_y = std::max(std::abs(camera.cy), std::abs(camera.height - camera.cy)) / camera.fy;
  if (slope_x <= kMaxSlope && slope_y <= kMaxSlope) return {};
  return reject("intrinsics",
                fmt::format("{}: fx {} fy {} cx {} cy {} with {} x {} pixels look more than 89 "
                            "degrees to the side",
                            type, camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height));
}

Decoded<void> inflate_exactly(const char* type, std::span<const std::uint8_t> data, std::span<std::uint8_t> out) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return reject("encoding", fmt::format("{}: zlib cannot start", type));
  stream.next_in = const_cast<Bytef*>(data.data());  // zlib's interface; it does not write there
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  const int result = inflate(&stream, Z_FINISH);
  const std::size_t written = out.size() - stream.avail_out;
  const bool is_whole = result == Z_STREAM_END && stream.avail_out == 0 && stream.avail_in == 0;
  inflateEnd(&stream);
  if (is_whole) return {};
  return reject("encoding", fmt::format("{}: zlib data of {} bytes gave {} of {} bytes of pixels (zlib: {})", type,
                                        data.size(), written, out.size(), result));
}

Decoded<DepthScan> scan_of(const WireImage& image, std::size_t image_bytes, const ScanFormat& format,
                           std::size_t max_bytes) {
  if (image.utime <= 0) return reject("time", fmt::format("{}: utime is {}, must be > 0", image.type, image.utime));
  const auto size = check_image_size(image.type, image.width, image.height, image_bytes, max_bytes);
  if (!size) return tl::make_unexpected(size.error());
  if (!format.intrinsics) {
    return reject("intrinsics", fmt::format("{} brings no intrinsics: set inputs[].intrinsics to [fx, fy, cx, cy] of "
                                            "its {} x {} pixels",
                                            image.type, image.width, image.height));
  }
  DepthScan scan;
  scan.utime = image.utime;
  scan.depth_scale_m = image.pixels == PixelKind::kFloat32 ? format.depth_unit_m : image.unit_m;
  PinholeIntrinsics& camera = scan.intrinsics = *format.intrinsics;
  if (camera.width > 0 && (camera.width != image.width || camera.height != image.height)) {
    return reject("intrinsics", fmt::format("{}: {} x {} pixels, but inputs[].intrinsics are of {} x {}", image.type,
                                            image.width, image.height, camera.width, camera.height));
  }
  camera.width = image.width;
  camera.height = image.height;
  const bool is_inside =
      camera.cx >= 0.0 && camera.cx <= camera.width && camera.cy >= 0.0 && camera.cy <= camera.height;
  if (!is_inside) {
    return reject("intrinsics", fmt::format("{}: the centre {} {} of inputs[].intrinsics is outside of {} x {} pixels",
                                            image.type, camera.cx, camera.cy, camera.width, camera.height));
  }
  if (const auto checked = check_intrinsics(image.type, camera); !checked) return tl::make_unexpected(checked.error());
  return scan;
}

Decoded<DecodedScan> to_depth_scan(const WireImage& image, const ScanFormat& format, std::size_t max_bytes) {
  const auto height = static_cast<std::size_t>(std::max(image.height, 0));
  const std::size_t pixels = static_cast<std::size_t>(std::max(image.width, 0)) * height;
  const std::size_t image_bytes =
      image.packing == Packing::kPng ? 2 * pixels : static_cast<std::size_t>(std::max(image.row_stride, 0)) * height;
  auto scan = scan_of(image, std::max(image_bytes, size_of(image.pixels) * pixels), format, max_bytes);
  if (!scan) return tl::make_unexpected(scan.error());
  if (image.packing == Packing::kPng) {
    if (const auto size = check_data_size(image, image_bytes); !size) return tl::make_unexpected(size.error());
    auto depth = read_png(image.type, image.data, image.width, image.height);
    if (!depth) return tl::make_unexpected(depth.error());
    scan->depth = std::move(*depth);
    return DecodedScan{std::move(*scan), image.seq};
  }
  if (const auto stride = check_row_stride(image); !stride) return tl::make_unexpected(stride.error());
  if (const auto size = check_data_size(image, image_bytes); !size) return tl::make_unexpected(size.error());
  std::vector<std::uint8_t> unpacked;
  Rows rows{image.data, static_cast<std::size_t>(image.row_stride)};
  if (image.packing == Packing::kZlib) {
    unpacked.resize(image_bytes);
    if (const auto done = inflate_exactly(image.type, image.data, unpacked); !done) {
      return tl::make_unexpected(done.error());
    }
    rows.bytes = unpacked;
  }
  scan->depth.resize(pixels);
  image.pixels == PixelKind::kUint16 ? copy_uint16(rows, image.is_big_endian, *scan)
                                     : copy_float32(rows, image.is_big_endian, *scan);
  return DecodedScan{std::move(*scan), image.seq};
}

}  // namespace planemap::service

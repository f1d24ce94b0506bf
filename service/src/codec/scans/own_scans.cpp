// planemap_lcm.depth_scan_t and point_scan_t.
#include <spdlog/fmt/fmt.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <planemap_lcm/depth_scan_t.hpp>

#include "codec/scans/depth_image.hpp"
#include "codec/scans/families.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::depth_scan_t;

constexpr const char* kDepthType = "depth_scan_t";
constexpr std::int32_t kMaxPointValues = 30000000;  // floats; point_scan_t.lcm

std::uint32_t checksum(std::span<const std::uint8_t> bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

/// What stands before the pixels of a depth_scan_t.
struct DepthHeader {
  DepthScan scan;  ///< without its pixels
  std::int32_t seq = 0;
  std::int8_t encoding = 0;
  std::span<const std::uint8_t> data;
  std::uint32_t crc32 = 0;
};

Decoded<DepthHeader> read_depth_header(WireReader& reader, std::size_t message_bytes) {
  DepthHeader header;
  header.scan.utime = reader.i64();
  header.seq = reader.i32();
  auto& camera = header.scan.intrinsics;
  camera.width = reader.i32();
  camera.height = reader.i32();
  camera.fx = reader.f64();
  camera.fy = reader.f64();
  camera.cx = reader.f64();
  camera.cy = reader.f64();
  header.scan.depth_scale_m = reader.f64();
  header.encoding = reader.i8();
  const std::int32_t size = reader.i32();
  if (!reader.ok())
    return reject("truncated", fmt::format("depth_scan_t: ends within its header, at byte {}", message_bytes));
  if (size < 0 || static_cast<std::size_t>(size) + 4 != reader.remaining()) {
    return reject("size", fmt::format("depth_scan_t: size is {}, but {} bytes follow (4 of them the checksum)", size,
                                      reader.remaining()));
  }
  header.data = reader.bytes(static_cast<std::size_t>(size));
  header.crc32 = static_cast<std::uint32_t>(reader.i32());
  return header;
}

Decoded<std::size_t> check_depth_header(const DepthHeader& header, std::size_t max_bytes) {
  const auto& camera = header.scan.intrinsics;
  if (header.scan.utime <= 0)
    return reject("time", fmt::format("depth_scan_t: utime is {}, must be > 0", header.scan.utime));
  const std::size_t image_bytes = 2 * static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  if (const auto size = check_image_size(kDepthType, camera.width, camera.height, image_bytes, max_bytes); !size) {
    return tl::make_unexpected(size.error());
  }
  if (const auto checked = check_intrinsics(kDepthType, camera); !checked) return tl::make_unexpected(checked.error());
  if (!std::isfinite(header.scan.depth_scale_m) || header.scan.depth_scale_m <= 0.0) {
    return reject("intrinsics",
                  fmt::format("depth_scan_t: depth_scale_m is {}, must be finite and > 0", header.scan.depth_scale_m));
  }
  return image_bytes;
}

/// Takes a count of floats and the floats' bytes off the reader.
Decoded<std::span<const std::uint8_t>> take_floats(WireReader& reader, const char* name, std::size_t max_bytes) {
  const std::int32_t count = reader.i32();
  if (!reader.ok()) return reject("truncated", fmt::format("point_scan_t: ends before {}", name));
  if (count < 0 || count > kMaxPointValues) {
    return reject("size", fmt::format("point_scan_t: {} is {} (allowed: 0 to {})", name, count, kMaxPointValues));
  }
  const std::size_t bytes = 4 * static_cast<std::size_t>(count);
  if (bytes > max_bytes) {
    return reject("too_large", fmt::format("point_scan_t: {} is {}, {} bytes; limits.image_bytes is {}", name, count,
                                           bytes, max_bytes));
  }
  if (bytes > reader.remaining()) {
    return reject("size",
                  fmt::format("point_scan_t: {} is {}, but only {} bytes follow", name, count, reader.remaining()));
  }
  return reader.bytes(bytes);
}

}  // namespace

Decoded<DecodedScan> decode_depth_scan(WireReader reader, std::size_t message_bytes, std::size_t max_bytes) {
  auto header = read_depth_header(reader, message_bytes);
  if (!header) return tl::make_unexpected(header.error());
  const auto image_bytes = check_depth_header(*header, max_bytes);
  if (!image_bytes) return tl::make_unexpected(image_bytes.error());
  const bool is_raw = header->encoding == depth_scan_t::ENCODING_RAW;
  if (!is_raw && header->encoding != depth_scan_t::ENCODING_ZLIB) {
    return reject("encoding", fmt::format("depth_scan_t: encoding is {} (allowed: {} raw, {} zlib)", header->encoding,
                                          depth_scan_t::ENCODING_RAW, depth_scan_t::ENCODING_ZLIB));
  }
  if (is_raw && header->data.size() != *image_bytes) {
    return reject("size",
                  fmt::format("depth_scan_t: {} bytes of raw data for {} x {} pixels, must be {}", header->data.size(),
                              header->scan.intrinsics.width, header->scan.intrinsics.height, *image_bytes));
  }
  if (!is_raw) {
    const PinholeIntrinsics& camera = header->scan.intrinsics;
    const auto packed =
        check_packed_size(kDepthType, "zlib", header->data.size(), camera.width, camera.height, *image_bytes);
    if (!packed) return tl::make_unexpected(packed.error());
  }
  // Checked before the pixels are unpacked: what was damaged on the way is not worth the work.
  if (const auto sum = checksum(header->data); sum != header->crc32) {
    return reject("checksum", fmt::format("depth_scan_t: crc32 of {} bytes is {:08x}, the message says {:08x}",
                                          header->data.size(), sum, header->crc32));
  }
  auto& depth = header->scan.depth;
  depth.resize(*image_bytes / 2);
  if (is_raw) {
    std::memcpy(depth.data(), header->data.data(), *image_bytes);
  } else {
    const std::span bytes(reinterpret_cast<std::uint8_t*>(depth.data()), *image_bytes);
    if (const auto done = inflate_exactly(kDepthType, header->data, bytes); !done) {
      return tl::make_unexpected(done.error());
    }
  }
  return DecodedScan{std::move(header->scan), header->seq};
}

Decoded<DecodedScan> decode_point_scan(WireReader reader, std::size_t max_bytes) {
  PointScan scan;
  scan.utime = reader.i64();
  const std::int32_t seq = reader.i32();
  const auto xyz = take_floats(reader, "n_values", max_bytes);
  if (!xyz) return tl::make_unexpected(xyz.error());
  const auto sigma = take_floats(reader, "n_sigma", max_bytes);
  if (!sigma) return tl::make_unexpected(sigma.error());
  const auto said_crc32 = static_cast<std::uint32_t>(reader.i32());
  if (!reader.ok()) return reject("truncated", "point_scan_t: ends before crc32");
  if (reader.remaining() != 0)
    return reject("size", fmt::format("point_scan_t: {} bytes too many", reader.remaining()));
  if (scan.utime <= 0) return reject("time", fmt::format("point_scan_t: utime is {}, must be > 0", scan.utime));
  if (xyz->size() % 12 != 0) {
    return reject("size", fmt::format("point_scan_t: n_values is {}, must be a multiple of 3", xyz->size() / 4));
  }
  if (!sigma->empty() && sigma->size() != xyz->size()) {
    return reject("size", fmt::format("point_scan_t: n_sigma is {}, must be 0 or n_values ({})", sigma->size() / 4,
                                      xyz->size() / 4));
  }
  if (const auto sum = checksum(*sigma, checksum(*xyz)); sum != said_crc32) {
    return reject("checksum", fmt::format("point_scan_t: crc32 is {:08x}, the message says {:08x}", sum, said_crc32));
  }
  scan.xyz_m.resize(xyz->size() / 4);
  copy_big_endian_floats(*xyz, scan.xyz_m);
  scan.sigma_m.resize(sigma->size() / 4);
  copy_big_endian_floats(*sigma, scan.sigma_m);
  return DecodedScan{std::move(scan), seq};
}

}  // namespace planemap::service

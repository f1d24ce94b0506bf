// drake.lcmt_image_array.
#include <spdlog/fmt/fmt.h>

#include <drake/lcmt_image.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "codec/scans/depth_image.hpp"
#include "codec/scans/families.hpp"

namespace planemap::service {
namespace {

using drake::lcmt_image;

constexpr const char* kType = "lcmt_image_array";
constexpr std::size_t kLeastHeaderBytes = 4 + 8 + 4 + 1;
constexpr std::size_t kMaxImages = 1000;
constexpr std::size_t kLeastImageBytes = kLeastHeaderBytes + 4 * 4 + 4;

struct Header {
  std::int32_t seq = 0;
  std::int64_t utime = 0;
  std::string_view frame;
};

Header read_header(WireReader& reader) {
  Header header;
  header.seq = reader.i32();
  header.utime = reader.i64();
  header.frame = reader.text();
  return header;
}

struct DrakeImage {
  WireImage image;
  std::string_view frame;
  std::int8_t pixel_format = 0;
  std::int8_t channel_type = 0;
  std::int8_t compression = 0;
};

DrakeImage read_image(WireReader& reader) {
  DrakeImage read;
  const Header header = read_header(reader);
  read.frame = header.frame;
  read.image.type = kType;
  read.image.utime = header.utime;
  read.image.seq = header.seq;
  read.image.width = reader.i32();
  read.image.height = reader.i32();
  read.image.row_stride = reader.i32();
  read.image.data = reader.bytes(reader.count(1));
  read.image.is_big_endian = reader.boolean();
  read.pixel_format = reader.i8();
  read.channel_type = reader.i8();
  read.compression = reader.i8();
  return read;
}

std::string frames_text(const std::vector<DrakeImage>& images) {
  std::vector<std::string_view> frames;
  frames.reserve(images.size());
  for (const DrakeImage& image : images) frames.push_back(image.frame.substr(0, 40));
  constexpr std::size_t kMostNamed = 8;
  const bool are_many = frames.size() > kMostNamed;
  if (are_many) frames.resize(kMostNamed);
  return fmt::format("'{}'{}", fmt::join(frames, "', '"), are_many ? ", ..." : "");
}

/// The depth image that is meant.
Decoded<DrakeImage> chosen(const std::vector<DrakeImage>& depths, std::size_t images, const std::string& frame) {
  if (depths.empty()) {
    return reject("no_depth", fmt::format("{}: none of {} images is depth (pixel_format 5)", kType, images));
  }
  if (frame.empty()) {
    if (depths.size() == 1) return depths.front();
    return reject("frame", fmt::format("{}: {} depth images, of frames {}: say which with inputs[].frame", kType,
                                       depths.size(), frames_text(depths)));
  }
  for (const DrakeImage& image : depths) {
    if (image.frame == frame) return image;
  }
  return reject("frame", fmt::format("{}: no depth image is of frame '{}' (inputs[].frame); there are {}", kType, frame,
                                     frames_text(depths)));
}

/// What the codes say, into the image.
Decoded<WireImage> with_codes(const DrakeImage& read) {
  WireImage image = read.image;
  if (read.channel_type == lcmt_image::CHANNEL_TYPE_FLOAT32) {
    image.pixels = PixelKind::kFloat32;
  } else if (read.channel_type != lcmt_image::CHANNEL_TYPE_UINT16) {
    return reject("format",
                  fmt::format("{}: channel_type of a depth image is {} (allowed: {} uint16, {} float32)", kType,
                              read.channel_type, lcmt_image::CHANNEL_TYPE_UINT16, lcmt_image::CHANNEL_TYPE_FLOAT32));
  }
  if (read.compression == lcmt_image::COMPRESSION_METHOD_ZLIB) {
    image.packing = Packing::kZlib;
  } else if (read.compression == lcmt_image::COMPRESSION_METHOD_PNG && image.pixels == PixelKind::kUint16) {
    image.packing = Packing::kPng;
  } else if (read.compression != lcmt_image::COMPRESSION_METHOD_NOT_COMPRESSED) {
    return reject("encoding", fmt::format("{}: compression_method of a depth image of {} is {} (allowed: 0 none, 1 "
                                          "zlib{})",
                                          kType, image.pixels == PixelKind::kUint16 ? "uint16" : "float32",
                                          read.compression, image.pixels == PixelKind::kUint16 ? ", 3 png" : ""));
  }
  return image;
}

}  // namespace

Decoded<DecodedScan> decode_image_array(WireReader reader, const ScanFormat& format, std::size_t max_bytes) {
  const Header header = read_header(reader);
  const std::size_t count = reader.count(kLeastImageBytes);
  if (count > kMaxImages) {
    return reject("size", fmt::format("{}: num_images is {} (allowed: up to {})", kType, count, kMaxImages));
  }
  std::vector<DrakeImage> depths;
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    DrakeImage image = read_image(reader);
    if (image.pixel_format == lcmt_image::PIXEL_FORMAT_DEPTH) depths.push_back(image);
  }
  if (const auto end = check_end(reader, kType); !end) return tl::make_unexpected(end.error());
  const auto depth = chosen(depths, count, format.frame);
  if (!depth) return tl::make_unexpected(depth.error());
  auto image = with_codes(*depth);
  if (!image) return tl::make_unexpected(image.error());
  if (image->utime == 0) image->utime = header.utime;
  return to_depth_scan(*image, format, max_bytes);
}

}  // namespace planemap::service

// The formats that are depth images.
#include <bit>
#include <cmath>
#include <cstring>

#include "formats/field_formats.hpp"
#include "formats/pixels.hpp"

namespace planemap::kinect_bridge {
namespace {

kinect::frame_msg_t kinect_frame(const DepthScan& scan, const std::vector<std::uint16_t>& pixels, Encoding encoding) {
  kinect::frame_msg_t frame{};
  frame.timestamp = scan.utime;
  frame.image.timestamp = scan.utime;
  frame.image.width = static_cast<std::int16_t>(scan.intrinsics.width);
  frame.image.height = static_cast<std::int16_t>(scan.intrinsics.height);
  auto& depth = frame.depth;
  depth.timestamp = scan.utime;
  depth.width = static_cast<std::int16_t>(scan.intrinsics.width);
  depth.height = static_cast<std::int16_t>(scan.intrinsics.height);
  depth.depth_data = little_endian(pixels);
  depth.uncompressed_size = static_cast<std::int32_t>(depth.depth_data.size());
  if (encoding == Encoding::kZlib) {
    depth.depth_data = deflated(depth.depth_data);
    depth.compression = kinect::depth_msg_t::COMPRESSION_ZLIB;
  }
  depth.depth_data_nbytes = static_cast<std::int32_t>(depth.depth_data.size());
  return frame;
}

bot_core::image_t bot_image(const DepthScan& scan) {
  bot_core::image_t image{};
  image.utime = scan.utime;
  image.width = scan.intrinsics.width;
  image.height = scan.intrinsics.height;
  image.row_stride = 2 * scan.intrinsics.width;
  image.pixelformat = bot_core::image_t::PIXEL_FORMAT_LE_GRAY16;
  image.data = little_endian(millimetres(scan));
  image.size = static_cast<std::int32_t>(image.data.size());
  return image;
}

std::vector<std::uint8_t> float_metres(const DepthScan& scan) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * scan.depth.size());
  for (const std::uint16_t depth : scan.depth) {
    const bool is_none = depth == kNoReturn || depth == kNoReturnHigh;
    const auto metres = is_none ? 0.0F : static_cast<float>(depth * scan.depth_scale_m);
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(metres));
  }
  return bytes;
}

}  // namespace

kinect::frame_msg_t to_kinect_frame(const DepthScan& scan, Encoding encoding) {
  auto frame = kinect_frame(scan, millimetres(scan), encoding);
  frame.depth.depth_data_format = kinect::depth_msg_t::DEPTH_MM;
  return frame;
}

kinect::frame_msg_t to_kinect_disparity(const DepthScan& scan, Encoding encoding) {
  constexpr std::uint16_t kNone = 2047;
  std::vector<std::uint16_t> disparities;
  disparities.reserve(scan.depth.size());
  const double numerator = 8.0 * scan.intrinsics.fx * kDisparityBaselineM / scan.depth_scale_m;
  for (const std::uint16_t depth : scan.depth) {
    const bool is_none = depth == kNoReturn || depth == kNoReturnHigh;
    const double d = is_none ? -1.0 : std::nearbyint(kDisparityOffset - numerator / depth);
    disparities.push_back(d >= 0.0 ? static_cast<std::uint16_t>(d) : kNone);
  }
  auto frame = kinect_frame(scan, disparities, encoding);
  frame.depth.depth_data_format = kinect::depth_msg_t::DEPTH_11BIT;
  return frame;
}

bot_core::images_t to_images(const DepthScan& scan, Encoding encoding) {
  bot_core::images_t images{};
  images.utime = scan.utime;
  images.n_images = 2;
  images.image_types = {bot_core::images_t::LEFT, encoding == Encoding::kZlib ? bot_core::images_t::DEPTH_MM_ZIPPED
                                                                              : bot_core::images_t::DEPTH_MM};
  images.images.resize(2);
  images.images[0].utime = scan.utime;
  auto& depth = images.images[1] = bot_image(scan);
  if (encoding == Encoding::kZlib) {
    depth.data = deflated(depth.data);
    depth.size = static_cast<std::int32_t>(depth.data.size());
  }
  return images;
}

bot_core::image_t to_image(const DepthScan& scan) {
  return bot_image(scan);
}

drake::lcmt_image_array to_image_array(const DepthScan& scan, DrakePixels pixels, Encoding encoding) {
  drake::lcmt_image_array array{};
  array.header.utime = scan.utime;
  array.num_images = 2;
  array.images.resize(2);
  array.images[0].header.utime = scan.utime;
  array.images[0].header.frame_name = "kinect_colour";
  array.images[0].pixel_format = drake::lcmt_image::PIXEL_FORMAT_RGB;
  array.images[0].channel_type = drake::lcmt_image::CHANNEL_TYPE_UINT8;
  auto& depth = array.images[1];
  const bool is_float = pixels == DrakePixels::kFloat32;
  depth.header.utime = scan.utime;
  depth.header.frame_name = kDepthFrame;
  depth.width = scan.intrinsics.width;
  depth.height = scan.intrinsics.height;
  depth.row_stride = (is_float ? 4 : 2) * scan.intrinsics.width;
  depth.pixel_format = drake::lcmt_image::PIXEL_FORMAT_DEPTH;
  depth.channel_type = is_float ? drake::lcmt_image::CHANNEL_TYPE_FLOAT32 : drake::lcmt_image::CHANNEL_TYPE_UINT16;
  depth.compression_method = drake::lcmt_image::COMPRESSION_METHOD_NOT_COMPRESSED;
  if (encoding == Encoding::kPng) {
    depth.data = png_of(millimetres(scan), scan.intrinsics.width, scan.intrinsics.height);
    depth.compression_method = drake::lcmt_image::COMPRESSION_METHOD_PNG;
  } else {
    depth.data = is_float ? float_metres(scan) : little_endian(millimetres(scan));
    if (encoding == Encoding::kZlib) {
      depth.data = deflated(depth.data);
      depth.compression_method = drake::lcmt_image::COMPRESSION_METHOD_ZLIB;
    }
  }
  depth.size = static_cast<std::int32_t>(depth.data.size());
  return array;
}

}  // namespace planemap::kinect_bridge

#include "formats/pixels.hpp"

#include <png.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace planemap::kinect_bridge {

std::vector<std::uint16_t> millimetres(const DepthScan& scan) {
  std::vector<std::uint16_t> depths = scan.depth;
  const double factor = scan.depth_scale_m / 0.001;
  for (std::uint16_t& depth : depths) {
    const double mm = depth == kNoReturnHigh ? 0.0 : std::nearbyint(factor * depth);
    depth = mm < kNoReturnHigh ? static_cast<std::uint16_t>(mm) : kNoReturn;
  }
  return depths;
}

std::vector<std::uint8_t> little_endian(const std::vector<std::uint16_t>& pixels) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * pixels.size());
  for (const std::uint16_t value : pixels) {
    bytes.push_back(static_cast<std::uint8_t>(value & 0xffU));
    bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
  }
  return bytes;
}

void append_little_endian(std::vector<std::uint8_t>& bytes, std::uint32_t word) {
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(word >> shift));
}

std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& raw) {
  uLongf size = compressBound(static_cast<uLong>(raw.size()));
  std::vector<std::uint8_t> bytes(size);
  if (compress2(bytes.data(), &size, raw.data(), static_cast<uLong>(raw.size()), Z_BEST_SPEED) != Z_OK) {
    throw std::runtime_error("zlib could not compress a depth image");
  }
  bytes.resize(size);
  return bytes;
}

std::vector<std::uint8_t> png_of(const std::vector<std::uint16_t>& pixels, int width, int height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_LINEAR_Y;
  image.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> bytes(size);
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0) {
    throw std::runtime_error(std::string("libpng could not compress a depth image: ") + image.message);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace planemap::kinect_bridge

#pragma once

#include <cstdint>
#include <filesystem>
#include <planemap/expected.hpp>
#include <vector>

namespace planemap::sources {

/// 16-bit image, row-major, width * height.
struct DepthImage {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  std::vector<std::uint16_t> depth;
};

constexpr int kMaxImageSide = 4096;  ///< pixels; checked before memory is taken

/// Reads a 16-bit grey PNG. Fails, naming the file, if it can't be read, is damaged or cut short, has another bit depth
/// or colour type, or a side above kMaxImageSide.
Expected<DepthImage> read_depth_png(const std::filesystem::path& path);

}  // namespace planemap::sources

#pragma once

#include <png.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace planemap::sources {

/// Writes a grey PNG; 8-bit ones take the low byte of each value.
inline void write_png(const std::filesystem::path& path, int width, int height,
                      const std::vector<std::uint16_t>& values, int bit_depth = 16) {
  std::filesystem::create_directories(path.parent_path());
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bit_depth,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int v = 0; v < height; ++v) {
    std::vector<png_byte> row;
    for (int u = 0; u < width; ++u) {
      const std::uint16_t value = values[static_cast<std::size_t>(v) * width + u];
      if (bit_depth == 16) row.push_back(static_cast<png_byte>(value >> 8U));  // PNG is big-endian
      row.push_back(static_cast<png_byte>(value & 0xffU));
    }
    png_write_row(png, row.data());
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

}  // namespace planemap::sources

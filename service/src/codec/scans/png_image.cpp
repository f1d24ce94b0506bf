#include "codec/scans/png_image.hpp"

#include <png.h>
#include <spdlog/fmt/fmt.h>

#include <array>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>

namespace planemap::service {
namespace {

constexpr png_alloc_size_t kMaxChunkBytes = 65536;  // of texts and colour profiles, which depth images have no use for

/// libpng's reader of bytes in memory. libpng reports errors by longjmp, so its calls live in functions that hold
/// nothing with a destructor.
class MemoryPng {
 public:
  explicit MemoryPng(std::span<const std::uint8_t> bytes)
      : rest_(bytes), png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~MemoryPng() { png_destroy_read_struct(&png_, &info_, nullptr); }
  MemoryPng(const MemoryPng&) = delete;
  MemoryPng& operator=(const MemoryPng&) = delete;

  bool good() const { return info_ != nullptr; }
  const char* message() const { return message_.data(); }

  /// Reads up to the first row.
  bool read_header(std::int32_t max_width, std::int32_t max_height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;  // NOLINT(cert-err52-cpp): libpng knows no other way
    png_set_read_fn(png_, this, on_read);
    png_set_chunk_malloc_max(png_, kMaxChunkBytes);
    png_set_user_limits(png_, static_cast<png_uint_32>(max_width), static_cast<png_uint_32>(max_height));
    png_read_info(png_, info_);
    return true;
  }

  /// @param pixels  width * height of the header
  bool read_rows(std::uint16_t* pixels, std::size_t width, std::size_t height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;  // NOLINT(cert-err52-cpp)
    if constexpr (std::endian::native == std::endian::little) png_set_swap(png_);
    for (std::size_t v = 0; v < height; ++v) {
      png_read_row(png_, reinterpret_cast<png_bytep>(pixels + v * width), nullptr);
    }
    png_read_end(png_, nullptr);
    return true;
  }

  std::uint32_t width() const { return png_get_image_width(png_, info_); }
  std::uint32_t height() const { return png_get_image_height(png_, info_); }
  int bit_depth() const { return png_get_bit_depth(png_, info_); }
  int channels() const { return png_get_channels(png_, info_); }
  bool is_depth() const {
    return png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY && bit_depth() == 16 &&
           png_get_interlace_type(png_, info_) == PNG_INTERLACE_NONE;
  }

 private:
  static void on_read(png_structp png, png_bytep out, std::size_t size) {
    auto* self = static_cast<MemoryPng*>(png_get_io_ptr(png));
    if (size > self->rest_.size()) png_error(png, "ends too early");
    std::memcpy(out, self->rest_.data(), size);
    self->rest_ = self->rest_.subspan(size);
  }
  [[noreturn]] static void on_error(png_structp png, png_const_charp text) {
    auto* self = static_cast<MemoryPng*>(png_get_error_ptr(png));
    std::snprintf(self->message_.data(), self->message_.size(), "%s", text);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp /*png*/, png_const_charp /*text*/) {}

  std::span<const std::uint8_t> rest_;
  std::array<char, 200> message_{};
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

Decoded<std::vector<std::uint16_t>> read_png(const char* type, std::span<const std::uint8_t> data, std::int32_t width,
                                             std::int32_t height) {
  MemoryPng png(data);
  if (!png.good()) return reject("encoding", fmt::format("{}: libpng could not be started", type));
  if (!png.read_header(width, height)) {
    return reject("encoding", fmt::format("{}: damaged PNG of {} bytes: {}", type, data.size(), png.message()));
  }
  if (!png.is_depth()) {
    return reject("encoding", fmt::format("{}: the PNG is no plain 16-bit grey image (bit depth {}, {} channels)", type,
                                          png.bit_depth(), png.channels()));
  }
  if (png.width() != static_cast<std::uint32_t>(width) || png.height() != static_cast<std::uint32_t>(height)) {
    return reject("encoding", fmt::format("{}: the PNG has {} x {} pixels, the message says {} x {}", type, png.width(),
                                          png.height(), width, height));
  }
  std::vector<std::uint16_t> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (!png.read_rows(pixels.data(), static_cast<std::size_t>(width), static_cast<std::size_t>(height))) {
    return reject("encoding", fmt::format("{}: damaged PNG of {} bytes: {}", type, data.size(), png.message()));
  }
  return pixels;
}

}  // namespace planemap::service

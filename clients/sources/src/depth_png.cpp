#include <png.h>

#include <array>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <memory>
#include <planemap/sources/depth_png.hpp>
#include <string>

namespace planemap::sources {
namespace {

constexpr std::size_t kSignatureBytes = 8;

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// libpng's reader. libpng reports errors by longjmp, so its calls live in functions that hold nothing with a
/// destructor.
class PngReader {
 public:
  PngReader() : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  bool good() const { return info_ != nullptr; }
  const char* message() const { return message_.data(); }

  /// Reads up to the first row. The signature has been read already.
  bool read_header(std::FILE* file) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;  // NOLINT(cert-err52-cpp): libpng knows no other way
    png_init_io(png_, file);
    png_set_sig_bytes(png_, kSignatureBytes);
    png_set_user_limits(png_, kMaxImageSide, kMaxImageSide);
    png_read_info(png_, info_);
    return true;
  }

  /// @param rows  one pointer for each row of the image
  bool read_rows(png_bytep* rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;  // NOLINT(cert-err52-cpp)
    if constexpr (std::endian::native == std::endian::little) png_set_swap(png_);
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  int width() const { return static_cast<int>(png_get_image_width(png_, info_)); }
  int height() const { return static_cast<int>(png_get_image_height(png_, info_)); }
  int bit_depth() const { return png_get_bit_depth(png_, info_); }
  int channels() const { return png_get_channels(png_, info_); }
  bool grey() const { return png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY; }
  bool interlaced() const { return png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE; }

 private:
  [[noreturn]] static void on_error(png_structp png, png_const_charp text) {
    auto* self = static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(self->message_.data(), self->message_.size(), "%s", text);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}

  std::array<char, 200> message_{};
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

/// Why an image is none that can be read as depth; empty if it can.
std::string objection_to(const PngReader& reader) {
  if (!reader.grey() || reader.bit_depth() != 16) {
    return "is no 16-bit grey image (bit depth " + std::to_string(reader.bit_depth()) + ", " +
           std::to_string(reader.channels()) + (reader.channels() == 1 ? " channel)" : " channels)");
  }
  if (reader.interlaced()) return "is interlaced, which depth images are not";
  return {};
}

}  // namespace

Expected<DepthImage> read_depth_png(const std::filesystem::path& path) {
  const auto refuse = [&path](const std::string& why) { return fail(path.string() + ": " + why); };
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rb"));
  if (!file) return refuse("can't be opened");
  std::array<unsigned char, kSignatureBytes> signature{};
  if (std::fread(signature.data(), 1, signature.size(), file.get()) != signature.size() ||
      png_sig_cmp(signature.data(), 0, signature.size()) != 0) {
    return refuse("is no PNG file");
  }
  PngReader reader;
  if (!reader.good()) return refuse("libpng could not be started");
  if (!reader.read_header(file.get())) return refuse(std::string("damaged PNG file: ") + reader.message());
  if (const std::string objection = objection_to(reader); !objection.empty()) return refuse(objection);

  DepthImage image{reader.width(), reader.height(), {}};
  image.depth.resize(static_cast<std::size_t>(image.width) * image.height);
  std::vector<png_bytep> rows(image.height);
  for (int v = 0; v < image.height; ++v) {
    rows[v] = reinterpret_cast<png_bytep>(image.depth.data() + static_cast<std::size_t>(v) * image.width);
  }
  if (!reader.read_rows(rows.data())) return refuse(std::string("damaged PNG file: ") + reader.message());
  return image;
}

}  // namespace planemap::sources

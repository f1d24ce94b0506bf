#include "codec/scans/png_image.hpp"
#include "fuzz_input.hpp"
#include "memory_bound.hpp"
#include "planemap/sources/depth_png.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  Input input(data, size);
  if (take_choice(input, 2) == 0) {
    // 8 x 6 pixels are asked for: no other size may take memory for its own.
    const MemoryBound bound(decoding_bound(input.size()) + (std::size_t{256} << 10));
    const auto image = service::read_png("fuzz", input, 8, 6);
    bound.check("read_png");
    require(!image || image->size() == 48, "another size than was asked for");
  } else {
    const MemoryFile file(input);
    const auto image = sources::read_depth_png(file.path());
    require(!image || image->depth.size() == static_cast<std::size_t>(image->width) * image->height, "size");
  }
  return 0;
}

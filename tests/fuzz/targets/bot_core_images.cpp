#include <bot_core/image_t.hpp>
#include <bot_core/images_t.hpp>

#include "scans.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap::fuzz;
  decode_and_map(lcm_message({data, size}, {bot_core::images_t::getHash(), bot_core::image_t::getHash()}),
                 Packing::kMaybeCompressed, full_format());
  return 0;
}

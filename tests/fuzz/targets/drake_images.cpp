#include <drake/lcmt_image_array.hpp>

#include "scans.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap::fuzz;
  decode_and_map(lcm_message({data, size}, {drake::lcmt_image_array::getHash()}), Packing::kMaybeCompressed,
                 full_format());
  return 0;
}

#include <kinect/frame_msg_t.hpp>

#include "scans.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap::fuzz;
  decode_and_map(lcm_message({data, size}, {kinect::frame_msg_t::getHash()}), Packing::kMaybeCompressed, full_format());
  return 0;
}

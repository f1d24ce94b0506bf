#include <bot_core/pointcloud2_t.hpp>
#include <drake/lcmt_point_cloud.hpp>

#include "scans.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap::fuzz;
  decode_and_map(lcm_message({data, size}, {bot_core::pointcloud2_t::getHash(), drake::lcmt_point_cloud::getHash()}),
                 Packing::kRaw);
  return 0;
}

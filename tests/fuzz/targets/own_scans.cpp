#include <planemap_lcm/depth_scan_t.hpp>
#include <planemap_lcm/point_scan_t.hpp>

#include "scans.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap::fuzz;
  decode_and_map(
      lcm_message({data, size}, {planemap_lcm::depth_scan_t::getHash(), planemap_lcm::point_scan_t::getHash()}),
      Packing::kMaybeCompressed);
  return 0;
}

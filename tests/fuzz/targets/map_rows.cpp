// Rows of a map file behind their checksums: whoever writes files can make these right.
#include "fuzz_input.hpp"
#include "memory_bound.hpp"
#include "store/block_codec.hpp"
#include "store/plane_row_codec.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  Input input(data, size);
  if (take_choice(input, 2) == 0) {
    const auto block = service::decode_block({1, -2, 3}, input);
    if (!block) return 0;
    const auto again = service::decode_block({1, -2, 3}, service::encode_block(**block));
    require(again && (*again)->size() == (*block)->size(), "a block that was taken is refused the second time");
  } else {
    const auto plane = service::decode_plane(7, input);
    if (!plane) return 0;
    const auto again = service::decode_plane(7, service::encode_plane(**plane));
    require(again.has_value(), "a plane that was taken is refused the second time");
  }
  return 0;
}

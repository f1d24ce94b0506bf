#include <planemap_lcm/reply_t.hpp>
#include <planemap_lcm/request_t.hpp>

#include "codec/request_codec.hpp"
#include "fuzz_input.hpp"
#include "memory_bound.hpp"
#include "serve/lcm/map_answers.hpp"
#include "small_map.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  const Bytes message = lcm_message({data, size}, {planemap_lcm::request_t::getHash()});
  const MemoryBound bound(decoding_bound(message.size()));
  const auto request = service::decode_request(message);
  bound.check("decode_request");
  if (!request || !service::is_map_operation(request->operation)) return 0;
  if (const auto refusal = service::check_arguments(*request)) {
    require(!refusal->message.empty(), "a refusal without words");
    return 0;
  }
  planemap_lcm::reply_t answer{};
  const auto refusal = service::answer_from(small_map(), *request, answer);
  require(!refusal || !refusal->message.empty(), "a refusal without words");
  return 0;
}

// What a client hears: a daemon of another version, or anybody on the bus.
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <planemap_lcm/status_t.hpp>

#include "fuzz_input.hpp"
#include "lcm/delta_collector.hpp"
#include "lcm/page_collector.hpp"
#include "lcm/reply_codec.hpp"
#include "memory_bound.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  const Bytes message = lcm_message({data, size}, {planemap_lcm::reply_t::getHash(), planemap_lcm::planes_t::getHash(),
                                                   planemap_lcm::status_t::getHash()});
  const MemoryBound bound(decoding_bound(message.size()));
  auto reply = client::decode_reply(message);
  auto delta = client::decode_delta(message);
  (void)client::decode_status_version(message);
  bound.check("decoding");
  if (reply) {
    client::PageCollector pages(reply->request_id);
    pages.add(*reply);
    if (pages.complete()) client::map_of(pages.take());
  }
  if (delta) {
    client::DeltaCollector deltas;
    deltas.add(std::move(*delta));
  }
  return 0;
}

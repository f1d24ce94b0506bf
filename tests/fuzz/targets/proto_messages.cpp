// Requests of planemap.v1 as gRPC hands them on, and what from_proto() takes from a stranger.
#include <planemap/v1/map.pb.h>
#include <planemap/v1/queries.pb.h>

#include "codec/proto_codec.hpp"
#include "codec/proto_question_codec.hpp"
#include "fuzz_input.hpp"
#include "small_map.hpp"

namespace {

using namespace planemap;
using namespace planemap::fuzz;

template <class Message>
bool parse(Input input, Message& message) {
  return message.ParseFromArray(input.data(), static_cast<int>(input.size()));
}

void nearest(Input input) {
  v1::NearestPlanesRequest message;
  if (!parse(input, message)) return;
  const auto queries = service::to_queries(message);
  if (!queries) return;
  for (std::size_t i = 0; i < queries->size() && i < 100; ++i) (void)small_map().nearest((*queries)[i]);
}

void rays(Input input) {
  v1::CastRaysRequest message;
  if (!parse(input, message)) return;
  if (const auto query = service::to_query(message)) (void)small_map().cast(query->rays, query->options);
}

void region(Input input) {
  v1::QueryRegionRequest message;
  if (!parse(input, message)) return;
  if (const auto query = service::to_query(message)) (void)small_map().region(*query);
}

void floorplan(Input input) {
  v1::GetFloorPlanRequest message;
  if (!parse(input, message)) return;
  if (const auto query = service::to_query(message)) (void)small_map().floorplan(*query);
}

void snapshot(Input input) {
  v1::Snapshot message;
  if (!parse(input, message)) return;
  const auto map = service::from_proto(message);
  if (!map) return;
  const auto again = service::from_proto(service::to_proto(*map));
  require(again.has_value(), "what was taken is refused the second time");
  require(again->planes.size() == map->planes.size(), "planes were lost on the way");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr void (*kKinds[])(Input) = {nearest, rays, region, floorplan, snapshot};
  Input input(data, size);
  kKinds[take_choice(input, std::size(kKinds))](input);
  return 0;
}

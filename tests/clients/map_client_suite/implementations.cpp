// Who runs the suite.
#include <planemap/client/grpc_map_client.hpp>
#include <planemap/client/in_process_map_client.hpp>
#include <planemap/client/lcm_map_client.hpp>
#include <planemap/client/service_source.hpp>

#include "suite.hpp"

namespace planemap::client {
namespace {

Way in_process(RoomService& room) {
  return {nullptr, std::make_unique<InProcessMapClient>(source_of(room.service(), "world"))};
}

Way over_lcm(RoomService& room) {
  return {nullptr, std::make_unique<LcmMapClient>(room.bus())};
}

Way over_grpc(RoomService& room) {
  auto door = std::make_unique<GrpcDoor>(room.service(), room.config());
  auto client = GrpcMapClient::connect(door->address());
  if (!client) throw std::runtime_error(client.error().message);
  return {std::move(door), std::move(*client)};
}

const Implementation kImplementations[] = {{"InProcess", in_process}, {"Lcm", over_lcm}, {"Grpc", over_grpc}};

constexpr auto kName = [](const auto& test) { return std::string(test.param.name); };

INSTANTIATE_TEST_SUITE_P(Clients, MapClientSuite, testing::ValuesIn(kImplementations), kName);
INSTANTIATE_TEST_SUITE_P(Clients, EmptyMapSuite, testing::ValuesIn(kImplementations), kName);

}  // namespace
}  // namespace planemap::client

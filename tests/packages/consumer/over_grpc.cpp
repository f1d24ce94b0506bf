// Prints how many planes the daemon's map has, asked over gRPC.

#include <chrono>
#include <cstdio>
#include <planemap/client/grpc_map_client.hpp>

int main() {
  const auto client = planemap::client::GrpcMapClient::connect("127.0.0.1:7670");
  if (!client) return std::fprintf(stderr, "%s\n", client.error().message.c_str()), 1;
  const auto map = (*client)->snapshot(std::chrono::seconds(5));
  if (!map) return std::fprintf(stderr, "%s\n", map.error().message.c_str()), 1;
  std::printf("%zu\n", map->planes.size());
  return 0;
}

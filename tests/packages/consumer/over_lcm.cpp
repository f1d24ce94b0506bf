// Prints how many planes the daemon's map has, asked over LCM.

#include <chrono>
#include <cstdio>
#include <planemap/client/lcm_map_client.hpp>
#include <planemap_lcm/status_t.hpp>

int main() {
  using namespace planemap::client;
  const auto client = LcmMapClient::connect(default_lcm_url());
  if (!client) return std::fprintf(stderr, "%s\n", client.error().message.c_str()), 1;
  const auto map = (*client)->snapshot(std::chrono::seconds(5));
  if (!map) return std::fprintf(stderr, "%s\n", map.error().message.c_str()), 1;
  std::printf("%zu\n", map->planes.size());
  return planemap_lcm::status_t::getHash() == 0 ? 1 : 0;  // the types are there, too
}

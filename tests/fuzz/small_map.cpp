#include "small_map.hpp"

#include <planemap/mapper.hpp>

#include "core/rooms.hpp"

namespace planemap::fuzz {

const SnapshotQueries& small_map() {
  static const SnapshotQueries queries = [] {
    const std::vector<testing::Wall> room = {{{0, 0, 1}, 0.0}, {{-1, 0, 0}, 2.5}, {{0, -1, 0}, 2.0}, {{0, 1, 0}, 2.0}};
    Mapper mapper(preset(Preset::kBest), /*epoch=*/77);
    for (std::uint64_t step = 0; step < 4; ++step) {
      const auto T = testing::looking({-1.0, 0.0, 1.2}, {1.0, 1.5 * std::sin(0.3 * static_cast<double>(step)), 0.8});
      mapper.integrate(testing::render(room, T, step, 1.0, 160, 120), T);
    }
    return SnapshotQueries(mapper.snapshot(), Eigen::Vector3d(0, 0, -1));
  }();
  return queries;
}

}  // namespace planemap::fuzz

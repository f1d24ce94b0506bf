#include <algorithm>
#include <cmath>

#include "planemap/plane_map.hpp"

namespace planemap {

Eigen::Vector3i CoarseIndex::cube_of(const Eigen::Vector3d& p_world_m) const {
  return (p_world_m * inverse_edge_).array().floor().cast<int>();
}

std::uint64_t CoarseIndex::cube_key(const Eigen::Vector3i& cube) {
  // 21 bits a coordinate: two million cubes each way.
  constexpr std::uint64_t kMask = (1ULL << 21) - 1;
  return (static_cast<std::uint64_t>(cube.x()) & kMask) | (static_cast<std::uint64_t>(cube.y()) & kMask) << 21 |
         (static_cast<std::uint64_t>(cube.z()) & kMask) << 42;
}

std::uint64_t CoarseIndex::key_of(const Eigen::Vector3d& p_world_m) const {
  return cube_key(cube_of(p_world_m));
}

void CoarseIndex::change(const Eigen::Vector3d& p_world_m, PlaneSlot plane, std::int32_t by) {
  std::vector<Entry>& entries = cubes_[cube_key(cube_of(p_world_m))];
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.plane == plane; });
  if (found == entries.end()) {
    entries.push_back({plane, by});
  } else if ((found->cells += by) == 0) {
    entries.erase(found);
  }
}

void CoarseIndex::planes_near(const Eigen::Vector3d& p_world_m, int steps, std::vector<PlaneSlot>& found) const {
  const Eigen::Vector3i middle = cube_of(p_world_m);
  for (int dz = -steps; dz <= steps; ++dz) {
    for (int dy = -steps; dy <= steps; ++dy) {
      for (int dx = -steps; dx <= steps; ++dx) {
        const auto cube = cubes_.find(cube_key(middle + Eigen::Vector3i(dx, dy, dz)));
        if (cube == cubes_.end()) continue;
        for (const Entry& entry : cube->second) found.push_back(entry.plane);
      }
    }
  }
}

}  // namespace planemap

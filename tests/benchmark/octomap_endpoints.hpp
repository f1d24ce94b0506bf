#pragma once

#include <octomap/octomap.h>

#include <vector>

namespace planemap::benchmark {

/// Marks the voxels that hold end points as occupied, each once; no rays. Inner nodes are not brought up to date.
/// @param xyz_m  x0 y0 z0 x1 ..., world frame
/// @param keys   memory that is used again
inline void mark_endpoints(const std::vector<float>& xyz_m, octomap::KeySet& keys, octomap::OcTree& tree) {
  keys.clear();
  for (std::size_t i = 0; i + 2 < xyz_m.size(); i += 3) {
    octomap::OcTreeKey key;
    if (tree.coordToKeyChecked(xyz_m[i], xyz_m[i + 1], xyz_m[i + 2], key)) keys.insert(key);
  }
  for (const octomap::OcTreeKey& key : keys) tree.updateNode(key, true, /*lazy_eval=*/true);
}

}  // namespace planemap::benchmark

#include "small_map.hpp"

#include <planemap/mapper.hpp>

#include "core/rooms.hpp"

namespace planemap::fuzz {

const SnapshotQueries& small_map() {
  static const SnapshotQueries queries(testing::looked_around(/*epoch=*/77, /*looks=*/4, preset(Preset::kBest)),
                                       Eigen::Vector3d(0, 0, -1));
  return queries;
}

}  // namespace planemap::fuzz

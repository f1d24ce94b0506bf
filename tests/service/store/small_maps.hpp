#pragma once

#include <memory>
#include <planemap/snapshot.hpp>
#include <string>

#include "../../core/rooms.hpp"
#include "store/block_codec.hpp"
#include "store/plane_row_codec.hpp"

namespace planemap::service {

using Snapshot = std::shared_ptr<const MapSnapshot>;

using testing::look;
using testing::looked_around;

/// Cells and planes as bytes: equal for maps that a file cannot tell apart.
inline std::string content(const MapSnapshot& map) {
  std::string text = std::to_string(map.utime()) + " " + std::to_string(map.cell_count()) + "\n";
  for (const auto& block : map.blocks()) {
    const auto bytes = encode_block(*block);
    text.append(bytes.begin(), bytes.end());
  }
  for (const auto& plane : map.planes()) {
    const auto bytes = encode_plane(*plane);
    text += std::to_string(plane->id);
    text.append(bytes.begin(), bytes.end());
  }
  return text;
}

/// All that a map is made of, as bytes.
inline std::string essence(const MapSnapshot& map) {
  std::string text = std::to_string(map.epoch()) + " " + std::to_string(map.revision()) + " " + content(map);
  for (const auto& gone : map.removed()) text += std::to_string(gone.id) + ">" + std::to_string(gone.merged_into);
  return text;
}

}  // namespace planemap::service

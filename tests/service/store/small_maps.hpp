#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <planemap/mapper.hpp>
#include <planemap/snapshot.hpp>
#include <string>
#include <vector>

#include "../../core/rooms.hpp"
#include "store/block_codec.hpp"
#include "store/plane_row_codec.hpp"

namespace planemap::service {

using Snapshot = std::shared_ptr<const MapSnapshot>;

/// One more look around a room of a floor and three walls.
inline void look(Mapper& mapper, int step) {
  const std::vector<testing::Wall> room = {{{0, 0, 1}, 0.0}, {{-1, 0, 0}, 2.5}, {{0, -1, 0}, 2.0}, {{0, 1, 0}, 2.0}};
  const auto T = testing::looking({-1.0, 0.0, 1.2}, {1.0, 1.5 * std::sin(0.3 * step), 0.8});
  mapper.integrate(testing::render(room, T, static_cast<std::uint64_t>(step), 1.0, 160, 120), T);
}

/// The map after so many looks.
inline Snapshot looked_around(std::uint64_t epoch, int looks, const MapperConfig& config = {}) {
  Mapper mapper(config, epoch);
  for (int i = 0; i < looks; ++i) look(mapper, i);
  return mapper.snapshot();
}

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

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace planemap::service

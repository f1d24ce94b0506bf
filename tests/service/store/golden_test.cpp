// Map files that were written by each format so far: they open, and are the same maps.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>
#include <zlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "small_maps.hpp"
#include "store/map_reader.hpp"
#include "support/process.hpp"

namespace planemap::service {
namespace {

namespace fs = std::filesystem;

template <class Numbers>
std::string joined(const Numbers& numbers) {
  std::string text;
  for (const auto& x : numbers) text += fmt::format(" {:.9g}", x);
  return text;
}

std::string line_of(const Block& block, std::size_t i) {
  const Cell& cell = block.cell(i);
  const auto index = block.cell_index(i);
  std::string line = fmt::format("{} {} {} {} of {} {:.9g} {:.9g}:", index.x(), index.y(), index.z(), cell.is_second,
                                 cell.plane, cell.sums.count, cell.plane_weight);
  for (const auto* v : {&cell.sums.square_m2, &cell.sums.error_m2, &cell.sums.view}) line += joined(*v);
  line += joined(cell.sums.first_m) + joined(cell.evidence.first) + joined(cell.evidence.second);
  line += fmt::format(" {:.9g} {:.9g} {:.9g} {:.9g}", cell.evidence.weight, cell.evidence_count, cell.normal_count,
                      cell.deviation_rad);
  for (const float x : cell.normal) line += fmt::format(" {:.4f}", x);  // it was made anew, by a square root
  return line + '\n';
}

/// All that a file says, in words that are not those of its format; of the cells of each block a checksum.
std::string listing(const StoredMap& map) {
  const MapSnapshot& s = *map.snapshot;
  std::string text = fmt::format("frame {}\ngravity {}\nconfig {}\nclosed {}\n", map.facts.frame, map.facts.gravity,
                                 map.facts.config, map.closed);
  text += fmt::format("epoch {} revision {} utime {} cells of {} m, dense with more than {}\n", s.epoch(), s.revision(),
                      s.utime(), s.cell_size_m(), s.density_threshold());
  text += fmt::format("next id {}, {} scans\n", s.state().next_plane_id, s.state().scans);
  for (const auto& plane : s.planes()) {
    text += fmt::format("plane {}:{} {:.17g}\n", plane->id, joined(plane->plane.normal()), plane->plane.d());
    text += fmt::format("  {} cells, {} points, seen {} to {}, quality {:.9g}, revision {}\n", plane->cell_count,
                        plane->point_count, plane->first_seen_utime, plane->last_seen_utime, plane->quality,
                        plane->revision);
    text += "  centroid" + joined(plane->centroid_m) + "\n  covariance" +
            joined(std::vector<double>(plane->covariance.data(), plane->covariance.data() + 16)) + "\n";
  }
  for (const auto& gone : s.removed()) {
    text += fmt::format("removed {} into {} at {}\n", gone.id, gone.merged_into, gone.revision);
  }
  for (const auto& block : s.blocks()) {
    std::string cells;
    for (std::size_t i = 0; i < block->size(); ++i) cells += line_of(*block, i);
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(cells.data()), static_cast<uInt>(cells.size()));
    text += fmt::format("block {} {} {}: {} cells {:08x}\n", block->index().x(), block->index().y(), block->index().z(),
                        block->size(), crc);
  }
  return text;
}

/// What the file of the newest format is made of.
Snapshot golden_map() {
  MapperConfig config;
  config.grid.cell_size_m = 0.25;
  auto parts = parts_of(*looked_around(77, 2, config));
  parts.removed.push_back({parts.state.next_plane_id++, parts.planes.front()->id, parts.revision});
  return std::make_shared<const MapSnapshot>(std::move(parts));
}

std::string path_of(int format, const char* extension) {
  return fmt::format("{}/tests/service/store/golden/format_{}.{}", PLANEMAP_SOURCE_DIR, format, extension);
}

TEST(GoldenMaps, OfAllFormatsOpenAndAreTheSame) {
  if (std::getenv("PLANEMAP_WRITE_GOLDEN") != nullptr) {
    const std::string path = path_of(kMapFileFormat, "planemap");
    ASSERT_TRUE(write_map_file(path, {"hall", "0 0 -1", "grid: {cell_size_m: 0.25}", ""}, golden_map()));
    std::ofstream(path_of(kMapFileFormat, "txt")) << listing(*MapFile::read(path));
    GTEST_SKIP() << path << " is written anew";
  }
  for (int format = 1; format <= kMapFileFormat; ++format) {
    const auto map = MapFile::read(path_of(format, "planemap"));
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(listing(*map), read_file(path_of(format, "txt"))) << "format " << format;
    EXPECT_GE(map->snapshot->planes().size(), 3u);
    MapperConfig config;
    config.grid.cell_size_m = 0.25;
    EXPECT_TRUE(Mapper::restore(config, *map->snapshot)) << "a mapper goes on with it";
  }
}

}  // namespace
}  // namespace planemap::service

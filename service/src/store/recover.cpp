#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>
#include <utility>

#include "store/map_parts.hpp"
#include "store/map_reader.hpp"

namespace planemap::service {
namespace {

/// Reads rows from a key on; where a page of the table is damaged, goes on behind it.
/// @param read  reads from a key on, and returns through its second argument the key behind the last row that it read
template <class Read>
std::size_t read_past_damage(std::int64_t end, Read&& read) {
  std::size_t holes = 0;
  std::int64_t skip = 1;
  for (std::int64_t from = 0; from < end;) {
    std::int64_t next = from;
    try {
      read(from, next);
      return holes;
    } catch (const SqliteError&) {
      if (next > from) {
        skip = 1;
        ++holes;
      }
      from = next + skip;
      skip *= 2;
    }
  }
  return holes;
}

/// The cells that carry a plane's label, summed up anew.
std::map<PlaneSlot, PlaneStatistics> statistics_of(const MapSnapshot::Parts& parts) {
  std::map<PlaneSlot, PlaneStatistics> sums;
  for (const auto& plane : parts.planes) {
    sums.emplace(static_cast<PlaneSlot>(plane->id), PlaneStatistics(plane->state->statistics.origin_m()));
  }
  for (const auto& block : parts.blocks) {
    for (std::size_t i = 0; i < block->size(); ++i) {
      const auto found = sums.find(block->cell(i).plane);
      if (found == sums.end() || !(block->cell(i).sums.count > 0.0)) continue;
      found->second.add(block->cell(i),
                        (block->cell_index(i).cast<double>().array() + 0.5).matrix() * parts.cell_size_m);
    }
  }
  return sums;
}

/// A plane that lost cells: fitted anew to those that are left, and as uncertain as its evidence has become less.
/// nullptr: they span no plane.
std::shared_ptr<const PlaneRecord> refitted(const PlaneRecord& old, const PlaneStatistics& left) {
  const auto fit = left.cell_count() > 0 ? left.fit(true) : std::nullopt;
  if (!fit || !(left.weight() > 0.0)) return nullptr;
  auto record = std::make_shared<PlaneRecord>(old);
  auto state = std::make_shared<PlaneState>(*old.state);
  state->statistics = left;
  state->fit = *fit;
  record->plane = fit->plane;
  record->centroid_m = fit->centroid_m;
  record->covariance *= std::max(1.0, old.state->statistics.weight() / left.weight());
  record->cell_count = static_cast<std::uint32_t>(left.cell_count());
  record->point_count = static_cast<std::uint64_t>(left.point_count());
  record->state = std::move(state);
  return record;
}

void drop_labels(MapSnapshot::Parts& parts, const std::map<PlaneSlot, PlaneStatistics>& kept) {
  for (std::size_t b = 0; b < parts.blocks.size(); ++b) {
    std::shared_ptr<Block> changed;
    for (std::size_t i = 0; i < parts.blocks[b]->size(); ++i) {
      const PlaneSlot plane = parts.blocks[b]->cell(i).plane;
      if (plane == kNoSlot || kept.count(plane) != 0) continue;
      if (!changed) changed = std::make_shared<Block>(*parts.blocks[b]);
      changed->cell(i).plane = kNoSlot;
    }
    if (changed) parts.blocks.set(b, std::move(changed));
  }
}

void mend(MapSnapshot::Parts& parts, std::size_t& lost_planes) {
  auto left = statistics_of(parts);
  std::vector<std::shared_ptr<const PlaneRecord>> kept;
  for (const auto& plane : parts.planes) {
    const auto slot = static_cast<PlaneSlot>(plane->id);
    const PlaneStatistics& sums = left.at(slot);
    auto record = sums.cell_count() == plane->cell_count ? plane : refitted(*plane, sums);
    if (record) {
      kept.push_back(std::move(record));
    } else {
      left.erase(slot);
      ++lost_planes;
    }
  }
  parts.planes = std::move(kept);
  drop_labels(parts, left);
}

}  // namespace

StoreExpected<Recovered> recover_map(const std::filesystem::path& path) {
  const auto failed = [&](const std::string& why) {
    return tl::make_unexpected(
        StoreError{StoreError::Kind::kDamaged, fmt::format("{}: nothing can be recovered: {}", path.string(), why)});
  };
  try {
    Database database(path, Database::Access::kRead);
    Recovered recovered;
    MapSnapshot::Parts parts;
    const FactRows facts = read_facts(database);
    take_facts(facts, recovered.map, parts);
    const auto stated_blocks = Facts(facts).whole<std::int64_t>("blocks");
    std::int64_t rows = 0;
    read_past_damage(std::min<std::int64_t>(stated_blocks, 1 << 28), [&](std::int64_t from, std::int64_t& next) {
      read_blocks(database, from, [&](std::int64_t slot, Expected<std::shared_ptr<Block>> block, std::uint32_t) {
        next = slot + 1;
        if (!block) return;
        ++rows;
        parts.cell_count += (*block)->size();
        parts.blocks.push_back(std::move(*block));
      });
    });
    recovered.lost_blocks = static_cast<std::size_t>(std::max<std::int64_t>(stated_blocks - rows, 0));
    read_past_damage(static_cast<std::int64_t>(parts.state.next_plane_id), [&](std::int64_t from, std::int64_t& next) {
      read_planes(database, from, [&](PlaneId id, Expected<std::shared_ptr<const PlaneRecord>> plane, std::uint32_t) {
        next = static_cast<std::int64_t>(id) + 1;
        if (plane && id < parts.state.next_plane_id) parts.planes.push_back(std::move(*plane));
      });
    });
    const auto stated_planes = Facts(facts).whole<std::size_t>("planes");
    recovered.lost_planes = stated_planes - std::min(stated_planes, parts.planes.size());
    mend(parts, recovered.lost_planes);
    if (parts.blocks.empty()) return failed("no block is whole");
    parts.state.next_plane_id = std::max(parts.state.next_plane_id, recovered.map.reserved_ids);
    recovered.map.snapshot = std::make_shared<const MapSnapshot>(std::move(parts));
    if (auto good = check_stored(*recovered.map.snapshot); !good) return failed(good.error().message);
    return recovered;
  } catch (const std::exception& error) {
    return failed(error.what());
  }
}

}  // namespace planemap::service

// Pieces of one plane across a gap.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "angles.hpp"
#include "planemap/plane_map.hpp"
#include "sort_unique.hpp"

namespace planemap {

namespace {

/// A plane looks for pieces across a gap when it has grown by a tenth, and at the latest after so many scans that touch
/// it: its fit gets better without growth.
constexpr int kBridgingScans = 10;

}  // namespace

/// A piece across a gap from where the scan looks: the work does not grow with the plane, and the plane grows nowhere
/// else.
PlaneSlot PlaneMap::bridge_partner(const UncertainGrid& grid, std::span<const CellChange> changes, PlaneSlot slot) {
  const State& plane = state(slot);
  cubes_.clear();
  near_.clear();
  for (const CellChange& change : changes) {
    if (grid.cell(change.cell).plane != slot) continue;
    const Eigen::Vector3d centre_m = grid.geometric_centre_m(change.cell);
    const std::uint64_t key = coarse_.key_of(centre_m);
    if (!cubes_.empty() && cubes_.back() == key) continue;
    if (std::find(cubes_.begin(), cubes_.end(), key) != cubes_.end()) continue;
    cubes_.push_back(key);
    coarse_.planes_near(centre_m, 2, near_);
  }
  sort_unique(near_);
  for (const PlaneSlot other : near_) {
    if (other == slot) continue;
    const State& partner = state(other);
    // Two tables of one height are two tables: only pieces that are large against the gap are taken for one surface.
    if (std::min(plane.statistics.cells_extent_m(), partner.statistics.cells_extent_m()) < 2.0 * config_.bridge_gap_m)
      continue;
    if (agree(plane.statistics, plane.fit, partner.statistics, partner.fit, config_.bridge_angle_deg * kRadPerDeg,
              0.5 * config_.plane_offset_m)) {
      return other;
    }
  }
  return kNoSlot;
}

void PlaneMap::bridge(UncertainGrid& grid, std::span<const CellChange> changes, GlobalReport& report) {
  candidates_ = touched_;
  for (PlaneSlot slot : candidates_) {
    while (states_[slot]) {
      State& plane = state(slot);
      const std::size_t cells = plane.statistics.cell_count();
      const bool grown = static_cast<double>(cells) >= 1.1 * static_cast<double>(plane.cells_when_bridged);
      if (!grown && ++plane.scans_since_bridged < kBridgingScans) break;
      const PlaneSlot partner = bridge_partner(grid, changes, slot);
      if (partner == kNoSlot) {
        plane.cells_when_bridged = cells;
        plane.scans_since_bridged = 0;
        break;
      }
      slot = merge_planes(grid, slot, partner);
      ++report.merged_planes;
    }
  }
}

}  // namespace planemap

#include "planemap/plane_map.hpp"

namespace planemap {

void PlaneMap::wear_away(UncertainGrid& grid, std::span<const CellRef> cells) {
  for (const CellRef ref : cells) {
    if (const PlaneSlot slot = grid.cell(ref).plane; slot != kNoSlot) {
      ++state(slot).worn_cells;
      leave(grid, ref);
    }
    grid.writable(ref).begin_anew();
    // The normals around were fitted to these points, too: they are fitted again with the next points there.
    grid.for_each_neighbour(ref, 1, [&](CellRef other) {
      if (grid.cell(other).normal_count > 0.0F) grid.writable(other).normal_count = 0.0F;
    });
  }
  for (const PlaneSlot slot : touched_) {
    reweigh(grid, slot);
    refit(slot);
    if (is_worn_out(slot)) {
      dissolve(grid, slot);
    } else {
      state(slot).touched = false;
    }
  }
  touched_.clear();
}

bool PlaneMap::is_worn_out(PlaneSlot slot) const {
  // What remains of a thing that has gone is where it touched what is still there: up to two rows of cells, which hold
  // both or are too near to be told from it. No plane of its own.
  constexpr double kStripCells = 2.5;
  const State& plane = state(slot);
  const std::size_t members = plane.statistics.cell_count();
  if (3 * members < static_cast<std::size_t>(config_.min_cells) || members == 0) return true;
  return plane.worn_cells >= members && (members < static_cast<std::size_t>(config_.min_cells) ||
                                         plane.fit.width_m() < kStripCells * grid_config_.cell_size_m);
}

}  // namespace planemap

#pragma once

#include <planemap/assignment.hpp>
#include <planemap/uncertain_grid.hpp>
#include <vector>

namespace planemap::testing {

/// Puts what a scan adds into cells that have no plane.
inline void commit(UncertainGrid& grid, const std::vector<CellChange>& changes) {
  for (const CellChange& change : changes) {
    Cell& cell = grid.writable(change.cell);
    cell.add(change.added, cell.direction(change.added));
  }
}

}  // namespace planemap::testing

#include "planemap/neighbourhoods.hpp"

namespace planemap {

void Neighbourhoods::gather(const UncertainGrid& grid, std::span<const CellChange> changes) {
  cells_.clear();
  begins_.clear();
  begins_.push_back(0);
  for (const CellChange& change : changes) {
    grid.for_each_neighbour(change.cell, 1, [&](CellRef other) { cells_.push_back(other); });
    begins_.push_back(static_cast<std::uint32_t>(cells_.size()));
  }
}

}  // namespace planemap

#include "planemap/neighbourhoods.hpp"

namespace planemap {

void Neighbourhoods::begin(std::size_t changes) {
  for (std::size_t part = 0; part <= kParts; ++part) {
    firsts_[part] = static_cast<std::uint32_t>(changes * part / kParts);
  }
}

void Neighbourhoods::gather(const UncertainGrid& grid, std::span<const CellChange> changes, std::size_t part) {
  std::vector<CellRef>& cells = parts_[part].cells;
  std::vector<std::uint32_t>& begins = parts_[part].begins;
  cells.clear();
  begins.assign(1, 0);
  for (std::uint32_t i = first_of(part); i < first_of(part + 1); ++i) {
    grid.for_each_neighbour(changes[i].cell, 1, [&](CellRef other) { cells.push_back(other); });
    begins.push_back(static_cast<std::uint32_t>(cells.size()));
  }
}

void Neighbourhoods::gather(const UncertainGrid& grid, std::span<const CellChange> changes) {
  begin(changes.size());
  for (std::size_t part = 0; part < kParts; ++part) gather(grid, changes, part);
}

}  // namespace planemap

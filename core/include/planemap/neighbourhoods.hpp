#pragma once

#include <cstdint>
#include <planemap/assignment.hpp>
#include <planemap/uncertain_grid.hpp>
#include <span>
#include <vector>

namespace planemap {

/// The cells around each changed cell, gathered once for all steps of a scan.
class Neighbourhoods {
 public:
  /// Forgets the last scan, and looks around each of the changed cells: 26-connected, one step, the cell itself and
  /// second cells included, in the order of UncertainGrid::for_each_neighbour().
  void gather(const UncertainGrid& grid, std::span<const CellChange> changes);
  /// @param change  place of the cell among the changes, which is its Cell::working
  std::span<const CellRef> around(std::uint32_t change) const {
    return {cells_.data() + begins_[change], cells_.data() + begins_[change + 1]};
  }

 private:
  std::vector<CellRef> cells_;
  std::vector<std::uint32_t> begins_;  ///< in cells_, by change; one more behind the last
};

}  // namespace planemap

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <planemap/assignment.hpp>
#include <planemap/uncertain_grid.hpp>
#include <span>
#include <vector>

namespace planemap {

/// The cells around each changed cell, gathered once for all steps of a scan, in two parts that two threads may gather.
class Neighbourhoods {
 public:
  static constexpr std::size_t kParts = 2;

  /// Forgets the last scan, and cuts this one's changes in parts.
  void begin(std::size_t changes);
  /// The first change of a part; that of kParts is one behind the last.
  std::uint32_t first_of(std::size_t part) const { return firsts_[part]; }
  /// Looks around each of the changed cells of a part: 26-connected, one step, the cell itself and second cells
  /// included, in the order of UncertainGrid::for_each_neighbour().
  void gather(const UncertainGrid& grid, std::span<const CellChange> changes, std::size_t part);
  /// begin(), and all parts.
  void gather(const UncertainGrid& grid, std::span<const CellChange> changes);
  /// @param change  place of the cell among the changes, which is its Cell::working
  std::span<const CellRef> around(std::uint32_t change) const {
    const std::size_t number = change < firsts_[1] ? 0 : 1;
    const Part& part = parts_[number];
    const std::uint32_t at = change - firsts_[number];
    return {part.cells.data() + part.begins[at], part.cells.data() + part.begins[at + 1]};
  }

 private:
  struct alignas(64) Part {
    std::vector<CellRef> cells;
    std::vector<std::uint32_t> begins;  ///< in cells, by change of the part; one more behind the last
  };
  std::array<Part, kParts> parts_;
  std::array<std::uint32_t, kParts + 1> firsts_{};
};

}  // namespace planemap

#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <planemap/cell.hpp>
#include <vector>

namespace planemap {

/// Whole-numbered place in the grid: of a cell, or of a block of 8x8x8 cells.
using CellIndex = Eigen::Vector3i;
using BlockIndex = Eigen::Vector3i;

constexpr int kBlockBits = 3;
constexpr int kBlockEdge = 1 << kBlockBits;  ///< cells along an edge of a block
constexpr int kBlockCells = kBlockEdge * kBlockEdge * kBlockEdge;

/// Teschner et al., Optimized Spatial Hashing, 2003; then mixed, since the buckets are taken from the low bits.
struct BlockIndexHash {
  std::size_t operator()(const BlockIndex& i) const {
    std::uint64_t h = static_cast<std::uint32_t>(i.x()) * 73856093ULL ^
                      static_cast<std::uint32_t>(i.y()) * 19349663ULL ^ static_cast<std::uint32_t>(i.z()) * 83492791ULL;
    h = (h ^ h >> 29) * 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(h >> 32);
  }
};

/// The block that holds a cell; arithmetic shift, so it rounds down below zero too.
inline BlockIndex block_of(const CellIndex& c) {
  return {c.x() >> kBlockBits, c.y() >> kBlockBits, c.z() >> kBlockBits};
}
/// A cell's place within its block, 0 to 511; x runs fastest.
inline int place_of(const CellIndex& c) {
  constexpr int kMask = kBlockEdge - 1;
  return (c.x() & kMask) | ((c.y() & kMask) << kBlockBits) | ((c.z() & kMask) << (2 * kBlockBits));
}
inline CellIndex cell_at(const BlockIndex& block, int place) {
  constexpr int kMask = kBlockEdge - 1;
  return {(block.x() << kBlockBits) + (place & kMask), (block.y() << kBlockBits) + ((place >> kBlockBits) & kMask),
          (block.z() << kBlockBits) + (place >> (2 * kBlockBits))};
}

/// 8x8x8 cells, stored packed: a plane through a block touches a fifth of its cells.
class Block {
 public:
  Block() : Block(BlockIndex::Zero()) {}
  explicit Block(const BlockIndex& index) { restart(index); }
  /// Becomes a block without cells; keeps its memory.
  void restart(const BlockIndex& index) {
    index_ = index;
    ordinal_.fill(kAbsent);
    rows_.fill(0);
    places_.clear();
    cells_.clear();
  }
  /// Makes room for cells, and for no more.
  void reserve(std::size_t cells) {
    places_.reserve(cells);
    cells_.reserve(cells);
  }
  std::size_t capacity() const { return cells_.capacity(); }

  const BlockIndex& index() const { return index_; }
  std::size_t size() const { return cells_.size(); }
  /// The cell that was added as the n-th. Cells keep their ordinal for ever.
  Cell& cell(std::size_t ordinal) { return cells_[ordinal]; }
  const Cell& cell(std::size_t ordinal) const { return cells_[ordinal]; }
  int place(std::size_t ordinal) const { return places_[ordinal]; }
  CellIndex cell_index(std::size_t ordinal) const { return cell_at(index_, places_[ordinal]); }

  /// Ordinal of the cell at a place; -1: never observed.
  int find(int place) const {
    const std::uint16_t ordinal = ordinal_[static_cast<std::size_t>(place)];
    return ordinal == kAbsent ? -1 : ordinal & kOrdinal;
  }
  /// Which places of a row along x have cells: bit x. @param row  y + 8 z, within the block
  std::uint8_t row(int row) const { return rows_[static_cast<std::size_t>(row)]; }
  /// Calls visit(ordinal) for the cell at a place, and for the second cell there. @pre there is one
  template <class Visit>
  void visit_place(int place, Visit&& visit) const {
    const std::uint16_t ordinal = ordinal_[static_cast<std::size_t>(place)];
    const auto first = static_cast<std::uint32_t>(ordinal & kOrdinal);
    visit(first);
    if ((ordinal & kHasSecond) != 0) visit(std::uint32_t{cells_[first].second});
  }
  /// Ordinal of the cell at a place, which is made where there was none.
  int find_or_add(int place);
  /// Ordinal of the other cell at the place of a cell, which is made where there was none.
  int find_or_add_second(int ordinal);

 private:
  static constexpr std::uint16_t kAbsent = 0xffff;
  static constexpr std::uint16_t kHasSecond = 0x8000;  ///< spares a look at the cell
  static constexpr std::uint16_t kOrdinal = 0x7fff;

  BlockIndex index_;
  std::array<std::uint16_t, kBlockCells> ordinal_;  ///< of the cell at each place, with kHasSecond; kAbsent: none
  std::array<std::uint8_t, kBlockEdge * kBlockEdge> rows_;
  std::vector<std::uint16_t> places_;
  std::vector<Cell> cells_;
};

inline int Block::find_or_add(int place) {
  std::uint16_t& ordinal = ordinal_[static_cast<std::size_t>(place)];
  if (ordinal == kAbsent) {
    ordinal = static_cast<std::uint16_t>(cells_.size());
    cells_.emplace_back();
    places_.push_back(static_cast<std::uint16_t>(place));
    rows_[static_cast<std::size_t>(place >> kBlockBits)] |= static_cast<std::uint8_t>(1 << (place & (kBlockEdge - 1)));
  }
  return ordinal & kOrdinal;
}

inline int Block::find_or_add_second(int ordinal) {
  const auto first = static_cast<std::size_t>(ordinal);
  if (cells_[first].second == Cell::kNoSecond) {
    cells_[first].second = static_cast<std::uint16_t>(cells_.size());
    cells_.emplace_back().is_second = true;
    places_.push_back(places_[first]);
    ordinal_[places_[first]] |= kHasSecond;
  }
  return cells_[first].second;
}

}  // namespace planemap

#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>
#include <planemap/block.hpp>
#include <planemap/block_table.hpp>
#include <type_traits>
#include <unordered_map>
#include <vector>

namespace planemap {

/// Where a cell is stored. Cells stay where they were made, so a reference holds as long as the grid.
struct CellRef {
  std::uint32_t block = 0;    ///< slot of the block in the grid
  std::uint32_t ordinal = 0;  ///< of the cell in the block

  bool operator==(const CellRef&) const = default;
  bool operator<(const CellRef& other) const {
    return block != other.block ? block < other.block : ordinal < other.ordinal;
  }
};

/// The dynamic grid (paper, section III): a hash of blocks in the world frame. Blocks are shared with snapshots and
/// copied before the first write after that. Not thread-safe: one thread owns it.
class UncertainGrid {
 public:
  explicit UncertainGrid(double cell_size_m);  ///< Throws std::invalid_argument unless finite and > 0.

  double cell_size_m() const { return cell_size_m_; }
  CellIndex index_of(const Eigen::Vector3d& p_world_m) const;        ///< floor(): half-open cells, also below zero.
  Eigen::Vector3d geometric_centre_m(const CellIndex& index) const;  ///< of the cube, world frame
  Eigen::Vector3d geometric_centre_m(CellRef ref) const { return geometric_centre_m(index_of(ref)); }
  CellIndex index_of(CellRef ref) const { return blocks_[ref.block]->cell_index(ref.ordinal); }
  std::size_t cell_count() const { return cell_count_; }
  std::size_t block_count() const { return blocks_.size(); }

  std::optional<CellRef> find(const CellIndex& index) const;  ///< Empty: never observed.
  /// The cell at the index, which is made where there was none. Its block becomes writable.
  CellRef find_or_add(const CellIndex& index);
  /// The cell that holds the other surface at the place of a cell, which is made where there was none. Its block
  /// becomes writable. @pre the cell is not itself such a one
  CellRef find_or_add_second(CellRef ref);
  /// The other cell at the place of a cell. Empty: there is none.
  std::optional<CellRef> sibling(CellRef ref) const;
  /// Slot of a block; empty: it holds no cell.
  std::optional<std::uint32_t> find_block(const BlockIndex& index) const;
  const Block& block(std::uint32_t slot) const { return *blocks_[slot]; }
  const Cell& cell(CellRef ref) const { return blocks_[ref.block]->cell(ref.ordinal); }
  /// For changes; copies the block where a snapshot shares it.
  Cell& writable(CellRef ref) { return writable_block(ref.block).cell(ref.ordinal); }

  /// The cell's virtual centre, Eq. 1: E[C_u] = L / n, world frame. @pre the cell has points
  Eigen::Vector3d virtual_centre_m(CellRef ref) const { return geometric_centre_m(ref) + cell(ref).sums.mean_m(); }

  /// Where the cell's surface is, world frame: the virtual centre, but of two cells at one place the first also has the
  /// points of before they were told apart, and its evidence has not. @pre the cell has points
  Eigen::Vector3d middle_m(CellRef ref) const {
    const Cell& cell = this->cell(ref);
    if (cell.second == Cell::kNoSecond || !cell.has_evidence()) return virtual_centre_m(ref);
    return geometric_centre_m(ref) + cell.evidence.unpacked().mean();
  }

  /// Calls visit(CellRef), or visit(CellRef, step) with the step from the cell, for each stored cell at most `depth`
  /// steps away, 26-connected (Definition 2), the cell itself included; where two cells share a place, one right after
  /// the other.
  template <class Visit>
  void for_each_neighbour(CellRef ref, int depth, Visit&& visit) const;
  /// Calls visit(CellRef) for each stored cell.
  template <class Visit>
  void for_each_cell(Visit&& visit) const;

  /// Takes in a block, which is copied before it changes. @pre it holds no block of that index
  void add_block(const std::shared_ptr<const Block>& block);
  /// Makes a table that of the blocks as they are now, in the order in which they were made; they are copied before
  /// they change again. Takes the memory that the table has.
  void share(BlockTable& table);

 private:
  static constexpr std::uint32_t kNoBlock = 0xffffffff;

  std::uint32_t block_slot(const BlockIndex& index) const;
  std::uint32_t make_block(const BlockIndex& index);
  Block& writable_block(std::uint32_t slot) {
    if (written_since_[slot] != shares_) make_own(slot, blocks_[slot]->size());
    return *blocks_[slot];
  }
  /// The same, with room for one more cell.
  Block& growing_block(std::uint32_t slot);
  void make_own(std::uint32_t slot, std::size_t cells);
  std::shared_ptr<Block> take_block(std::size_t cells);

  double cell_size_m_;
  double inverse_cell_size_;
  std::size_t cell_count_ = 0;
  std::unordered_map<BlockIndex, std::uint32_t, BlockIndexHash> slots_;
  BlockTable table_;                          ///< holds the blocks, and is what readers get
  std::vector<Block*> blocks_;                ///< the same
  std::vector<std::uint64_t> written_since_;  ///< by slot: value of shares_ when the block was made or copied
  std::uint64_t shares_ = 0;                  ///< how often the blocks were shared
  std::vector<Pool<Block>> pools_;  ///< by room: of equal ones, so that memory does not grow by being passed on
  std::vector<std::array<std::uint32_t, 27>> neighbours_;  ///< slots of the blocks around each block
};

template <class Visit>
void UncertainGrid::for_each_neighbour(CellRef ref, int depth, Visit&& visit) const {
  constexpr int kMask = kBlockEdge - 1;
  const int place = blocks_[ref.block]->place(ref.ordinal);
  const auto& around = neighbours_[ref.block];
  const int x = place & kMask;
  const int y = place >> kBlockBits & kMask;
  const int z = place >> (2 * kBlockBits);
  // Row by row along x: the part of a row that lies in one block is a few bits of a byte.
  for (int dz = -depth; dz <= depth; ++dz) {
    for (int dy = -depth; dy <= depth; ++dy) {
      const int there = ((y + dy) & kMask) + (((z + dz) & kMask) << kBlockBits);
      const int beside = 3 * (((y + dy) >> kBlockBits) + 1) + 9 * (((z + dz) >> kBlockBits) + 1);
      for (int dx = -depth; dx <= depth;) {
        const int first = x + dx;
        const int last = std::min(x + depth, first | kMask);  // in the same block
        const int towards = (first >> kBlockBits) + 1 + beside;
        const std::uint32_t slot = around[static_cast<std::size_t>(towards)];
        dx = last + 1 - x;
        if (slot == kNoBlock) continue;
        const Block& block = *blocks_[slot];
        unsigned bits = block.row(there) & (0xffU >> (kMask - (last & kMask))) & (0xffU << (first & kMask));
        for (; bits != 0; bits &= bits - 1) {
          const int at = std::countr_zero(bits);
          block.visit_place(at + (there << kBlockBits), [&](std::uint32_t ordinal) {
            if constexpr (std::is_invocable_v<Visit, CellRef, CellIndex>) {
              visit(CellRef{slot, ordinal}, CellIndex((first & ~kMask) + at - x, dy, dz));
            } else {
              visit(CellRef{slot, ordinal});
            }
          });
        }
      }
    }
  }
}

template <class Visit>
void UncertainGrid::for_each_cell(Visit&& visit) const {
  for (std::uint32_t slot = 0; slot < blocks_.size(); ++slot) {
    for (std::uint32_t ordinal = 0; ordinal < blocks_[slot]->size(); ++ordinal) visit(CellRef{slot, ordinal});
  }
}

}  // namespace planemap

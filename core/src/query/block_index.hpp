#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <planemap/block.hpp>
#include <planemap/block_table.hpp>
#include <span>
#include <vector>

namespace planemap {

/// Where blocks are: from their index to their slot, and the part of the grid that holds them all. Immutable.
class BlockIndexTable {
 public:
  explicit BlockIndexTable(const BlockTable& blocks);

  /// Slot of the block; -1: there is none.
  std::int32_t find(const BlockIndex& index) const {
    std::size_t place = BlockIndexHash{}(index) & (entries_.size() - 1);
    while (entries_[place].slot >= 0 && entries_[place].index != index) place = (place + 1) & (entries_.size() - 1);
    return entries_[place].slot;
  }
  /// Index of each block, by slot.
  std::span<const BlockIndex> indices() const { return in_order_; }
  /// Least and greatest index of any block; empty of a map without blocks.
  const Eigen::AlignedBox3i& extent() const { return extent_; }
  /// Whether it is of the same blocks, in the same slots (their cells may differ).
  bool is_of(const BlockTable& blocks) const;

 private:
  struct Entry {
    BlockIndex index = BlockIndex::Zero();
    std::int32_t slot = -1;
  };

  std::vector<Entry> entries_;        ///< open addressing; a power of two, at most half full
  std::vector<BlockIndex> in_order_;  ///< by slot
  Eigen::AlignedBox3i extent_;
};

}  // namespace planemap

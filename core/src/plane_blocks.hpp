#pragma once

#include <cstddef>
#include <cstdint>
#include <planemap/block_table.hpp>
#include <planemap/cell.hpp>
#include <span>
#include <vector>

namespace planemap {

class Block;

/// Which planes have cells in which block of a map: so that whoever wants the cells of a few planes need not look at
/// all. Immutable.
class PlaneBlocks {
 public:
  /// @param blocks    of a snapshot
  /// @param previous  of an earlier snapshot that is still held, or nullptr: blocks that are still the same object are
  ///                  not looked at again
  explicit PlaneBlocks(const BlockTable& blocks, const PlaneBlocks* previous = nullptr);

  /// The planes with cells in a block, ascending; cells of no plane are not counted.
  std::span<const PlaneSlot> planes_in(std::size_t block) const {
    return std::span(planes_).subspan(begins_[block], begins_[block + 1] - begins_[block]);
  }

 private:
  std::vector<const Block*> blocks_;  ///< to be told apart only
  std::vector<std::size_t> begins_;   ///< of each block's planes in planes_, and the end
  std::vector<PlaneSlot> planes_;
};

}  // namespace planemap

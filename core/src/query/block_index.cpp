#include "query/block_index.hpp"

#include <algorithm>
#include <bit>

namespace planemap {

BlockIndexTable::BlockIndexTable(const BlockTable& blocks) : entries_(std::bit_ceil(2 * blocks.size() + 1)) {
  in_order_.reserve(blocks.size());
  for (const auto& block : blocks) {
    const BlockIndex& index = block->index();
    std::size_t place = BlockIndexHash{}(index) & (entries_.size() - 1);
    while (entries_[place].slot >= 0) place = (place + 1) & (entries_.size() - 1);
    entries_[place] = {index, static_cast<std::int32_t>(in_order_.size())};
    in_order_.push_back(index);
    extent_.extend(index);
  }
}

bool BlockIndexTable::is_of(const BlockTable& blocks) const {
  return std::equal(blocks.begin(), blocks.end(), in_order_.begin(), in_order_.end(),
                    [](const auto& block, const BlockIndex& index) { return block->index() == index; });
}

}  // namespace planemap

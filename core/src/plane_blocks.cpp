#include "plane_blocks.hpp"

#include <planemap/block.hpp>

#include "sort_unique.hpp"

namespace planemap {

namespace {

std::vector<PlaneSlot> planes_of(const Block& block) {
  std::vector<PlaneSlot> planes;
  PlaneSlot last = kNoSlot;  // neighbours are mostly of one plane
  for (std::size_t i = 0; i < block.size(); ++i) {
    const PlaneSlot plane = block.cell(i).plane;
    if (plane != last && plane != kNoSlot) planes.push_back(plane);
    last = plane;
  }
  sort_unique(planes);
  return planes;
}

}  // namespace

PlaneBlocks::PlaneBlocks(const BlockTable& blocks, const PlaneBlocks* previous) {
  blocks_.reserve(blocks.size());
  begins_.reserve(blocks.size() + 1);
  begins_.push_back(0);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Block* block = blocks[i].get();
    // Blocks keep their place in a map.
    if (previous != nullptr && i < previous->blocks_.size() && previous->blocks_[i] == block) {
      const auto known = previous->planes_in(i);
      planes_.insert(planes_.end(), known.begin(), known.end());
    } else {
      const auto planes = planes_of(*block);
      planes_.insert(planes_.end(), planes.begin(), planes.end());
    }
    blocks_.push_back(block);
    begins_.push_back(planes_.size());
  }
}

}  // namespace planemap

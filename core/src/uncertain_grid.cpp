#include "planemap/uncertain_grid.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace planemap {

namespace {

/// Blocks have room for a multiple of so many cells, and for one more than they hold.
constexpr std::size_t kRoomStep = 8;
/// Longer than readers keep a snapshot in turn, such as the saver for its interval: what they give back is needed
/// again.
constexpr std::uint64_t kSharesToATrim = 256;

}  // namespace

UncertainGrid::UncertainGrid(double cell_size_m) : cell_size_m_(cell_size_m), inverse_cell_size_(1.0 / cell_size_m) {
  if (!std::isfinite(cell_size_m) || cell_size_m <= 0.0) {
    throw std::invalid_argument("UncertainGrid: cell_size_m must be finite and > 0");
  }
}

CellIndex UncertainGrid::index_of(const Eigen::Vector3d& p_world_m) const {
  const Eigen::Array3d scaled = p_world_m.array() * inverse_cell_size_;
  return {static_cast<int>(std::floor(scaled.x())), static_cast<int>(std::floor(scaled.y())),
          static_cast<int>(std::floor(scaled.z()))};
}

Eigen::Vector3d UncertainGrid::geometric_centre_m(const CellIndex& index) const {
  return (index.cast<double>().array() + 0.5) * cell_size_m_;
}

std::optional<CellRef> UncertainGrid::find(const CellIndex& index) const {
  const std::uint32_t slot = block_slot(block_of(index));
  if (slot == kNoBlock) return std::nullopt;
  const int ordinal = blocks_[slot]->find(place_of(index));
  if (ordinal < 0) return std::nullopt;
  return CellRef{slot, static_cast<std::uint32_t>(ordinal)};
}

CellRef UncertainGrid::find_or_add(const CellIndex& index) {
  std::uint32_t slot = block_slot(block_of(index));
  if (slot == kNoBlock) slot = make_block(block_of(index));
  if (const int known = blocks_[slot]->find(place_of(index)); known >= 0) {
    return {slot, static_cast<std::uint32_t>(known)};
  }
  ++cell_count_;
  return {slot, static_cast<std::uint32_t>(growing_block(slot).find_or_add(place_of(index)))};
}

CellRef UncertainGrid::find_or_add_second(CellRef ref) {
  if (const std::uint16_t known = cell(ref).second; known != Cell::kNoSecond) return {ref.block, known};
  ++cell_count_;
  const int ordinal = growing_block(ref.block).find_or_add_second(static_cast<int>(ref.ordinal));
  return {ref.block, static_cast<std::uint32_t>(ordinal)};
}

std::optional<CellRef> UncertainGrid::sibling(CellRef ref) const {
  const Block& block = *blocks_[ref.block];
  const Cell& own = block.cell(ref.ordinal);
  if (own.is_second) return CellRef{ref.block, static_cast<std::uint32_t>(block.find(block.place(ref.ordinal)))};
  if (own.second == Cell::kNoSecond) return std::nullopt;
  return CellRef{ref.block, own.second};
}

std::optional<std::uint32_t> UncertainGrid::find_block(const BlockIndex& index) const {
  const std::uint32_t slot = block_slot(index);
  if (slot == kNoBlock) return std::nullopt;
  return slot;
}

std::uint32_t UncertainGrid::block_slot(const BlockIndex& index) const {
  const auto found = slots_.find(index);
  return found == slots_.end() ? kNoBlock : found->second;
}

std::uint32_t UncertainGrid::make_block(const BlockIndex& index) {
  const auto slot = static_cast<std::uint32_t>(blocks_.size());
  slots_.emplace(index, slot);
  std::shared_ptr<Block> block = take_block(0);
  block->restart(index);
  blocks_.push_back(block.get());
  table_.push_back(std::move(block));
  written_since_.push_back(shares_);
  neighbours_.emplace_back().fill(kNoBlock);
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::uint32_t other = block_slot(index + BlockIndex(dx, dy, dz));
        if (other == kNoBlock) continue;
        const int towards = (dx + 1) + 3 * (dy + 1) + 9 * (dz + 1);
        neighbours_[slot][static_cast<std::size_t>(towards)] = other;
        neighbours_[other][static_cast<std::size_t>(26 - towards)] = slot;
      }
    }
  }
  return slot;
}

void UncertainGrid::add_block(const std::shared_ptr<const Block>& block) {
  const std::uint32_t slot = make_block(block->index());
  blocks_[slot] = const_cast<Block*>(block.get());  // NOLINT(cppcoreguidelines-pro-type-const-cast): see below
  table_.set(slot, block);
  written_since_[slot] = shares_ - 1;  // shared: the first change is made to a copy
  cell_count_ += block->size();
}

Block& UncertainGrid::growing_block(std::uint32_t slot) {
  const std::size_t size = blocks_[slot]->size();
  if (written_since_[slot] != shares_ || size == blocks_[slot]->capacity()) make_own(slot, size + 1);
  return *blocks_[slot];
}

/// Replaces a block by a copy that no snapshot has.
void UncertainGrid::make_own(std::uint32_t slot, std::size_t cells) {
  std::shared_ptr<Block> copy = take_block(cells);
  *copy = *blocks_[slot];
  blocks_[slot] = copy.get();
  table_.set(slot, std::move(copy));
  written_since_[slot] = shares_;
}

std::shared_ptr<Block> UncertainGrid::take_block(std::size_t cells) {
  const std::size_t room = cells / kRoomStep + 1;
  if (pools_.size() <= room) pools_.resize(room + 1);
  return pools_[room].take([&] {
    auto block = std::make_unique<Block>();
    block->reserve(room * kRoomStep);
    return block;
  });
}

void UncertainGrid::share(BlockTable& table) {
  table_.share(table);
  ++shares_;
  if (shares_ % kSharesToATrim != 0) return;
  for (Pool<Block>& pool : pools_) pool.trim();
}

}  // namespace planemap

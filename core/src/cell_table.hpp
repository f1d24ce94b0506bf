#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace planemap {

/// From cells near the sensor to numbers, for one scan: open addressing, emptied by overwriting.
class CellTable {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;
  /// Cells are told apart by 21 bits of each coordinate.
  static constexpr std::int32_t kLimit = 1 << 20;

  CellTable() { clear(); }

  void clear() {
    slots_.assign(slots_.size(), Slot{});
    size_ = 0;
  }
  /// The number of a cell, which is kNone where it is new: its finder writes it. Valid until the next call.
  /// @pre each coordinate is in [-kLimit, kLimit)
  std::uint32_t& operator()(std::int32_t x, std::int32_t y, std::int32_t z) {
    if (2 * size_ >= slots_.size()) grow();
    const std::uint64_t key = key_of(x, y, z);
    Slot& slot = slots_[place_of(key)];
    if (slot.key != key) {
      slot = {key, kNone};
      ++size_;
    }
    return slot.number;
  }

 private:
  struct Slot {
    std::uint64_t key = ~std::uint64_t{0};
    std::uint32_t number = kNone;
  };

  static std::uint64_t key_of(std::int32_t x, std::int32_t y, std::int32_t z) {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
    return (static_cast<std::uint64_t>(x) & kMask) | (static_cast<std::uint64_t>(y) & kMask) << 21 |
           (static_cast<std::uint64_t>(z) & kMask) << 42;
  }
  /// Where the key is, or is to be put.
  std::size_t place_of(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t place = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 32) & mask;
    while (slots_[place].key != key && slots_[place].key != ~std::uint64_t{0}) place = (place + 1) & mask;
    return place;
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key != ~std::uint64_t{0}) slots_[place_of(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_ = std::vector<Slot>(4096);  ///< a power of two
  std::size_t size_ = 0;
};

}  // namespace planemap

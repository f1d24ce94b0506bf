#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace planemap::service {

static_assert(std::endian::native == std::endian::little,
              "the codec swaps bytes between LCM's big and a little endian");

/// Reads LCM's big-endian encoding without copying or taking memory. Reading past the end gives zeros and makes ok()
/// false, so a header may be read field by field and checked once.
class WireReader {
 public:
  explicit WireReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool ok() const { return ok_; }
  std::size_t remaining() const { return rest_.size(); }

  std::int8_t i8() { return static_cast<std::int8_t>(big_endian<std::uint8_t>()); }
  std::int16_t i16() { return static_cast<std::int16_t>(big_endian<std::uint16_t>()); }
  std::int32_t i32() { return static_cast<std::int32_t>(big_endian<std::uint32_t>()); }
  std::int64_t i64() { return static_cast<std::int64_t>(big_endian<std::uint64_t>()); }
  /// The count before a list whose items take at least so many bytes; 0 and not ok() where so many can't follow.
  std::size_t count(std::size_t least_item_bytes) {
    const std::int32_t value = i32();
    ok_ = ok_ && value >= 0 && static_cast<std::size_t>(value) <= rest_.size() / least_item_bytes;
    return ok_ ? static_cast<std::size_t>(value) : 0;
  }
  double f64() { return std::bit_cast<double>(big_endian<std::uint64_t>()); }

  bool boolean() { return i8() != 0; }
  /// A string, where it is, without the 0 at its end; not ok() where there is no such 0.
  std::string_view text() {
    const auto chars = bytes(count(1));
    ok_ = ok_ && !chars.empty() && chars.back() == 0;
    return ok_ ? std::string_view(reinterpret_cast<const char*>(chars.data()), chars.size() - 1) : std::string_view();
  }

  /// The next `count` bytes where they are; empty and not ok() if there are not so many.
  std::span<const std::uint8_t> bytes(std::size_t count) {
    if (count > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

 private:
  template <std::unsigned_integral T>
  T big_endian() {
    T value = 0;
    for (const std::uint8_t byte : bytes(sizeof(T)))
      value = static_cast<T>((static_cast<std::uint64_t>(value) << 8) | byte);
    return value;
  }

  std::span<const std::uint8_t> rest_;
  bool ok_ = true;
};

/// Copies big-endian floats into a little-endian array. @pre bytes.size() == 4 * out.size()
inline void copy_big_endian_floats(std::span<const std::uint8_t> bytes, std::span<float> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data() + 4 * i, 4);
    out[i] = std::bit_cast<float>(__builtin_bswap32(word));
  }
}

}  // namespace planemap::service

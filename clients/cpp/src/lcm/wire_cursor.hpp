#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace planemap::client {

/// Walks over an encoded LCM message without decoding it. Once something does not fit, ok() is false and stays so, and
/// every further step does nothing.
class WireCursor {
 public:
  explicit WireCursor(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool ok() const { return ok_; }
  std::size_t remaining() const { return rest_.size(); }

  void skip(std::size_t count) {
    ok_ = ok_ && count <= rest_.size();
    if (ok_) rest_ = rest_.subspan(count);
  }

  std::int64_t int64() { return static_cast<std::int64_t>(big_endian(8)); }
  std::int32_t int32() { return static_cast<std::int32_t>(static_cast<std::uint32_t>(big_endian(4))); }

  /// The count before an array whose elements take at least so many bytes; 0 if the array can't fit into the rest.
  std::size_t count(std::size_t least_element_bytes) {
    const std::int32_t value = int32();
    ok_ = ok_ && value >= 0 && static_cast<std::size_t>(value) <= rest_.size() / least_element_bytes;
    return ok_ ? static_cast<std::size_t>(value) : 0;
  }

  /// A string: its length with the closing zero, its characters, the zero.
  void string() {
    const std::size_t length = count(1);
    ok_ = ok_ && length >= 1 && rest_[length - 1] == 0;
    skip(length);
  }

 private:
  std::uint64_t big_endian(std::size_t width) {
    ok_ = ok_ && width <= rest_.size();
    if (!ok_) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < width; ++i) value = (value << 8u) | rest_[i];
    rest_ = rest_.subspan(width);
    return value;
  }

  std::span<const std::uint8_t> rest_;
  bool ok_ = true;
};

}  // namespace planemap::client

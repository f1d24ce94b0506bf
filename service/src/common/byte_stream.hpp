#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace planemap::service {

static_assert(std::endian::native == std::endian::little, "map files and bodies over HTTP are little-endian");

using Bytes = std::vector<std::uint8_t>;

/// Writes numbers one after the other, little-endian.
/// @tparam Storage  what they are written into: Bytes or std::string
template <class Storage = Bytes>
class ByteWriter {
 public:
  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.resize(bytes_.size() + sizeof(T));
    patch(bytes_.size() - sizeof(T), value);
  }
  /// Overwrites what was put at a place.
  template <class T>
  void patch(std::size_t at, T value) {
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
  }
  std::size_t size() const { return bytes_.size(); }
  Storage& bytes() { return bytes_; }

 private:
  Storage bytes_;
};

/// Reads them. Past the end it gives zeros, and ok() is false from then on.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <class T>
  T get() {
    T value{};
    if (rest_.size() < sizeof(T)) {
      ok_ = false;
      rest_ = {};
      return value;
    }
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
    return value;
  }
  /// The next bytes where they are; empty and not ok() if there are not so many.
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
  bool ok() const { return ok_; }
  std::size_t remaining() const { return rest_.size(); }

 private:
  std::span<const std::uint8_t> rest_;
  bool ok_ = true;
};

}  // namespace planemap::service

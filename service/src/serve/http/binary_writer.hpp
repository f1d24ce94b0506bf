#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <utility>

namespace planemap::service {

static_assert(std::endian::native == std::endian::little,
              "bodies are little endian, and written as they are in memory");

/// Appends numbers to a body.
class BinaryWriter {
 public:
  template <class T>
  void put(T value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  /// Overwrites what was put at a place.
  template <class T>
  void patch(std::size_t at, T value) {
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  std::size_t size() const { return bytes_.size(); }
  void truncate(std::size_t bytes) { bytes_.resize(bytes); }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace planemap::service

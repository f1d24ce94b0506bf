#pragma once

#include <cstddef>

namespace planemap::fuzz {

/// Between construction and check() the calling thread may hold at most so many bytes more than before. It is measured
/// where AddressSanitizer is; other builds only run the code.
class MemoryBound {
 public:
  explicit MemoryBound(std::size_t most_bytes);
  ~MemoryBound();
  MemoryBound(const MemoryBound&) = delete;
  MemoryBound& operator=(const MemoryBound&) = delete;
  /// Ends the process with what was taken, if that was more.
  void check(const char* what) const;

 private:
  std::size_t most_bytes_;
};

/// What decoding an uncompressed message may take: it is copied into a scan, and errors are sentences.
constexpr std::size_t decoding_bound(std::size_t input_bytes) {
  return 4 * input_bytes + (std::size_t{64} << 10);
}

}  // namespace planemap::fuzz

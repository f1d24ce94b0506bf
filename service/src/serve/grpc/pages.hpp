#pragma once

#include <cstddef>

namespace planemap::service {

/// No message is greater.
constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 20;
/// What a page has beside its items: versions, names, numbers; the name of the frame has 255 bytes at most.
constexpr std::size_t kPageHeaderBytes = 4096;

/// Counts what goes into a page.
class PageRoom {
 public:
  /// Whether an item of so many bytes goes into the page, too; then it is counted. The first always does.
  bool take(std::size_t item_bytes) {
    constexpr std::size_t kFraming = 8;  // tag and length
    const std::size_t bytes = item_bytes + kFraming;
    if (used_ > 0 && used_ + bytes > kMaxMessageBytes - kPageHeaderBytes) return false;
    used_ += bytes;
    return true;
  }

 private:
  std::size_t used_ = 0;
};

/// An item that takes more than a page must become smaller.
constexpr std::size_t kMaxItemBytes = kMaxMessageBytes - kPageHeaderBytes - 64;

}  // namespace planemap::service

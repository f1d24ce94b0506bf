#pragma once

#include <filesystem>
#include <planemap/expected.hpp>
#include <utility>

namespace planemap::service {

/// A lock that ends with the process, however it ends. SQLite's own would keep readers out, too.
class FileLock {
 public:
  FileLock() = default;
  ~FileLock();
  FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// Locks PATH.lock, which stays when the lock has ended. Fails where another process has it. Where that file cannot
  /// be made at all, nobody can write beside it either: then this is no lock, and no failure.
  static Expected<FileLock> take(const std::filesystem::path& path);

 private:
  int descriptor_ = -1;
};

}  // namespace planemap::service

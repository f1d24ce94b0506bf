#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <stop_token>
#include <thread>

#include "common/counters.hpp"

namespace planemap::service {

/// Copies a map file while it is written, on a thread and over a connection of its own: a copy of a large map takes
/// seconds, in which commits go on. The copy appears whole or not at all, beside the file as PATH.backup.
///
/// Counters: store.backups, store.backup_failures.
class BackupWriter {
 public:
  /// @param counters  must outlive it
  BackupWriter(const std::filesystem::path& path, Counters& counters);
  ~BackupWriter();
  BackupWriter(const BackupWriter&) = delete;
  BackupWriter& operator=(const BackupWriter&) = delete;

  /// Makes a backup of the file as it is now or later; the file must be there, and another connection of this process
  /// have it in WAL mode. While one is being written, the next one waits for it.
  void begin();
  /// Leaves a copy that is not done. Call it before the file's last connection is closed. The destructor does it, too.
  void stop();

 private:
  void run(const std::stop_token& stop);
  void write(const std::stop_token& stop);

  const std::filesystem::path path_;
  Counters& counters_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool wanted_ = false;  ///< under the mutex
  std::jthread thread_;  ///< last: ends before what it uses
};

}  // namespace planemap::service

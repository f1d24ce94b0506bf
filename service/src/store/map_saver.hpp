#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/counters.hpp"
#include "common/repeat_guard.hpp"
#include "mapping/map_keeper.hpp"
#include "mapping/mapping_service.hpp"
#include "store/backup_writer.hpp"
#include "store/map_store.hpp"

namespace planemap::service {

/// Writes the map into its file, on a thread of its own: what changed in each interval in one transaction, and now and
/// then has a backup made beside it. What fails is counted, said, and tried again with the next interval; the mapper
/// never waits.
///
/// Counters: store.commits, store.rows, store.failures, store.late_commits (that took longer than the interval), those
/// of the BackupWriter, store.degraded (1 or 0).
class MapSaver final : public MapKeeper {
 public:
  /// All that is handed in must outlive it.
  MapSaver(const StoreConfig& config, MapStore store, MappingService& mapping, Counters& counters);
  ~MapSaver() override;
  MapSaver(const MapSaver&) = delete;
  MapSaver& operator=(const MapSaver&) = delete;

  Expected<void> save(std::chrono::steady_clock::duration timeout) override;
  std::string problem() const override;
  /// The last commit, and closes the file. Call it once the mapper has ended. The destructor does it, too.
  void stop();

 private:
  void run(const std::stop_token& stop);
  void commit(bool closing);
  void note_time(std::chrono::steady_clock::duration taken);
  StoreExpected<std::size_t> write(const std::shared_ptr<const MapSnapshot>& map, bool closing);
  void back_up_if_due();
  void note(std::string problem);

  const StoreConfig config_;
  MappingService& mapping_;
  Counters& counters_;
  BackupWriter backups_;
  MapStore store_;  ///< of the saver's thread alone, like the three below
  RepeatGuard repeats_;
  std::chrono::steady_clock::time_point next_backup_;
  double backup_wait_s_;  ///< a map that grows has its first backups sooner

  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable_any changed_;
  std::string problem_;
  std::uint64_t asked_saves_ = 0;
  std::uint64_t done_saves_ = 0;

  std::jthread thread_;  ///< last: ends before what it uses
};

}  // namespace planemap::service

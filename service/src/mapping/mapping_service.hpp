#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/mapper.hpp>
#include <planemap/snapshot.hpp>
#include <shared_mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/counters.hpp"
#include "common/repeat_guard.hpp"
#include "config/service_config.hpp"
#include "mapping/helper_thread.hpp"
#include "mapping/map_keeper.hpp"
#include "mapping/scan_queue.hpp"

namespace planemap::service {

/// How the mapper gets on.
struct MappingStats {
  std::int64_t mapped = 0;           ///< scans
  std::int64_t last_scan_utime = 0;  ///< microseconds; 0: none yet
  double last_mapped_host_s = 0.0;   ///< the host's steady clock
  double rate_hz = 0.0;              ///< scans in the last second
  double scan_ms_p50 = 0.0;          ///< over the last 100 scans
  double scan_ms_max = 0.0;
  std::size_t queued = 0;                    ///< scans that wait for the mapper
  std::size_t queue_capacity = 0;            ///< scans
  std::optional<double> busy_since_host_s;   ///< when the mapper took the scan at hand; empty: none is
  std::int64_t dropped_from_full_queue = 0;  ///< scans
  double last_dropped_host_s = 0.0;
  std::string last_error;  ///< why the last scan that could not be mapped could not; empty: none
  double last_error_host_s = 0.0;
  bool is_paused = false;
  std::optional<double> reset_host_s;  ///< when the map was last begun anew on demand
};

/// A scan that is in the map now.
struct MappedScan {
  const RegisteredScan& scan;
  std::uint64_t epoch = 0;                     ///< of the map
  std::array<double, kStageCount> stage_ms{};  ///< by Stage
  double scan_ms = 0.0;                        ///< all of it
};

/// The map, on a thread of its own: takes registered scans, publishes a snapshot after each. Readers never wait for it.
class MappingService {
 public:
  /// @param epoch        names the life of a map that begins, below 2^53; scans of map number n (RegisteredScan) are
  ///                     mapped into that of epoch + n
  /// @param on_snapshot  called on the mapper's thread after each new snapshot; must return at once and throw nothing;
  ///                     may be empty
  /// @param initial      map to go on with, in its own epoch; maps that begin after it are of greater epochs than
  ///                     both, so that one that was lost before it was saved keeps its own. nullptr: an empty one
  /// @throws std::runtime_error if the initial map cannot be gone on with
  MappingService(const ServiceConfig& config, std::uint64_t epoch, Counters& counters,
                 std::function<void()> on_snapshot, const MapSnapshot* initial = nullptr);
  ~MappingService();
  MappingService(const MappingService&) = delete;
  MappingService& operator=(const MappingService&) = delete;

  /// Queues a scan; if the queue is full, its oldest one is dropped and counted. A scan of a greater map number than
  /// those before begins a new map. From any thread.
  void push(RegisteredScan&& scan);
  /// Told of each mapped scan, on the mapper's thread, once its snapshot is there and before it is counted; must return
  /// at once and throw nothing. Empty: nobody is told; once this has returned, the one before is not called any more.
  /// From any thread.
  void set_scan_listener(std::function<void(const MappedScan&)> listener);
  /// The newest snapshot, never nullptr; immutable. From any thread.
  std::shared_ptr<const MapSnapshot> snapshot() const;
  /// @param now_host_s  the host's steady clock, seconds
  MappingStats stats(double now_host_s) const;
  /// From now on scans are dropped and counted ("paused"), those that wait too; the map stays. From any thread.
  void pause();
  /// Scans are mapped again. From any thread.
  void resume();
  bool is_paused() const;
  /// Begins a new, empty map of a greater epoch once the scan at hand is mapped; scans that wait are dropped and
  /// counted ("reset"). From any thread.
  /// @return epoch of the new map; empty: the mapper did not come to it in time (it will), or has ended
  std::optional<std::uint64_t> reset(std::chrono::steady_clock::duration timeout);
  /// Who keeps the map; must outlive the service, or be taken away before with nullptr. From any thread.
  void set_keeper(MapKeeper* keeper);
  /// Commits the map to its file; fails where nobody keeps it, or that fails. From any thread.
  Expected<void> save(std::chrono::steady_clock::duration timeout);
  /// Whether there is a file that the map is kept in.
  bool has_keeper() const;
  /// Why the map is not being kept, in words; empty: it is, or is not meant to be.
  std::string keeper_problem() const;
  /// Ends the thread after the scan at hand; scans that still wait are dropped and counted. Called by the destructor,
  /// too.
  void stop();

 private:
  void run(const std::stop_token& stop);
  void map(const RegisteredScan& scan);
  void begin_new_map(std::uint64_t map_number);
  void begin_asked_maps();
  void publish(std::shared_ptr<const MapSnapshot> snapshot);
  void drop_waiting(const char* reason);
  void note_busy(std::optional<double> since_host_s);
  void note_error(std::string error);

  const MapperConfig config_;
  const std::uint64_t first_epoch_;
  Counters& counters_;
  std::function<void()> on_snapshot_;
  ScanQueue queue_;
  const std::unique_ptr<HelperThread> helper_;
  Mapper mapper_;                 ///< of the mapper's thread alone, like the three below
  std::uint64_t map_number_ = 0;  ///< of the map that is being made
  std::uint64_t resets_ = 0;      ///< maps that were begun on demand: each is one more life
  RepeatGuard repeats_;

  mutable std::mutex mutex_;  ///< of what follows; held for copies only
  std::shared_ptr<const MapSnapshot> snapshot_;
  MappingStats stats_;
  std::vector<double> scan_ms_;           ///< of the last 100 scans; short, and never gives its memory back
  std::vector<double> mapped_at_host_s_;  ///< of the last second
  std::uint64_t asked_resets_ = 0;
  std::uint64_t done_resets_ = 0;
  std::condition_variable reset_done_;

  std::mutex listener_mutex_;
  std::function<void(const MappedScan&)> scan_listener_;
  mutable std::shared_mutex keeper_mutex_;  ///< held while the keeper is asked
  MapKeeper* keeper_ = nullptr;

  std::jthread thread_;  ///< last: ends before what it uses
};

/// The host's steady clock in seconds.
double steady_now_s();

}  // namespace planemap::service

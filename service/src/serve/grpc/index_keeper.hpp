#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "config/service_config.hpp"
#include "mapping/mapping_service.hpp"
#include "serve/grpc/map_index.hpp"

namespace planemap::service {

/// Keeps an index of the newest snapshot, on a thread of its own: one for all calls, and made only while somebody asks
/// or watches. The mapper is never waited for, and never waits.
class IndexKeeper {
 public:
  static constexpr std::size_t kKeptIndexes = 8;
  static constexpr double kKeptS = 10.0;

  using OnIndex = std::function<void(const std::shared_ptr<const MapIndex>&)>;

  /// @param on_index  told of each new index, on the keeper's thread
  /// @param kept_s    for how long an index is kept after it was last asked for
  IndexKeeper(const ServiceConfig& config, const MappingService& mapping, OnIndex on_index, double kept_s = kKeptS);
  ~IndexKeeper();
  IndexKeeper(const IndexKeeper&) = delete;
  IndexKeeper& operator=(const IndexKeeper&) = delete;

  /// An index of the newest snapshot, or of one that was the newest at most grpc.index_age_s ago; never of another
  /// epoch than the newest. Waits while it is made.
  std::shared_ptr<const MapIndex> current();
  /// Keeps an index for of_version(): the last kKeptIndexes, each for a while after it was last asked for. An index
  /// holds its map's memory, also that of what has changed since.
  void keep(const std::shared_ptr<const MapIndex>& index);
  /// One that is kept, or nullptr: it is kept no more, or of another epoch than the newest.
  std::shared_ptr<const MapIndex> of_version(std::uint64_t epoch, std::uint64_t revision, std::int64_t utime);
  /// There is a new snapshot. Returns at once; from any thread.
  void wake();
  /// Somebody wants to be told of each new snapshot, at most once in grpc.watch_period_s; or not any more.
  void add_watcher();
  void remove_watcher();
  /// Ends the thread; current() then gives what there is. Called by the destructor, too.
  void stop();

 private:
  struct Kept {
    std::shared_ptr<const MapIndex> index;
    double asked_at_s = 0.0;
  };

  void keep_locked(const std::shared_ptr<const MapIndex>& index, double now_s);
  void forget_old(double now_s);
  void run(const std::stop_token& stop);
  bool has_to_build(double now_s) const;
  double due_in_s(double now_s) const;
  void build(std::unique_lock<std::mutex>& lock);

  const MappingService& mapping_;
  std::optional<Eigen::Vector3d> gravity_;
  const double index_age_s_;
  const double watch_period_s_;
  OnIndex on_index_;
  const double kept_s_;

  std::mutex mutex_;  ///< of what follows; not held while an index is made
  std::condition_variable_any woken_;
  std::condition_variable built_;
  std::shared_ptr<const MapIndex> index_;  ///< nullptr: none was asked for yet
  std::deque<Kept> kept_;                  ///< what was asked for last in front
  double taken_at_s_ = 0.0;                ///< when its snapshot was the newest
  std::uint64_t begun_ = 0;                ///< indexes whose making has begun
  std::uint64_t done_ = 0;
  double begun_at_s_ = 0.0;         ///< of the last that was begun: when its snapshot was the newest
  std::uint64_t coming_epoch_ = 0;  ///< its map
  std::uint64_t wanted_ = 0;        ///< the index of this number is waited for
  int watchers_ = 0;
  bool has_news_ = true;  ///< since the index's snapshot was taken
  bool is_stopped_ = false;

  std::jthread thread_;  ///< last: ends before what it uses
};

}  // namespace planemap::service

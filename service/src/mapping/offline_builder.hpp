#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <planemap/mapper.hpp>
#include <planemap/scan.hpp>
#include <planemap/snapshot.hpp>
#include <span>
#include <string>
#include <string_view>

#include "common/counters.hpp"
#include "config/service_config.hpp"
#include "mapping/stage_times.hpp"

namespace planemap::service {

/// Builds a map from recorded data with the same code as the daemon, on the caller's thread: nothing is dropped for
/// want of time, and scans wait for their poses by the messages' own times, so the same calls give the same map.
class OfflineBuilder {
 public:
  /// @param config  as load_config gave it
  /// @param epoch   names this map, below 2^53; by custom a hash of the input and the configuration. With pose.jump:
  ///                reset the n-th new map has epoch + n
  OfflineBuilder(const ServiceConfig& config, std::uint64_t epoch);
  ~OfflineBuilder();
  OfflineBuilder(const OfflineBuilder&) = delete;
  OfflineBuilder& operator=(const OfflineBuilder&) = delete;

  /// One event of an LCM log, in the log's order. An event's own time is not asked for: logs exist whose event times
  /// have nothing to do with those of the messages. Messages that can't be used are counted.
  /// @return whether the channel is one of the inputs'; others are passed over
  bool add_event(std::string_view channel, std::span<const std::uint8_t> message);

  /// One scan whose pose is known, for instance of a folder. Inputs' extrinsics, ranges and body masks do not apply,
  /// nor do the settings of poses.
  /// @param T_world_sensor  takes sensor coordinates to world coordinates
  ScanReport add_frame(const Scan& scan, const Eigen::Isometry3d& T_world_sensor);

  /// The end of a log: scans that still wait for a pose are mapped or dropped.
  void finish();

  /// The map as it is now; costs what changed since the last call.
  std::shared_ptr<const MapSnapshot> snapshot();

  CounterValues counters() const;     ///< the daemon's names: scans.received, scans.mapped, scans.dropped.no_pose, ...
  const PointCounts& points() const;  ///< of all mapped scans, also those of maps that were left behind
  const StageTimes& times() const;    ///< of all mapped scans, in order
  std::string last_problem() const;   ///< why the last unmapped scan or pose could not be used, in words; empty: none

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::service

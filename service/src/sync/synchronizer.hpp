#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <planemap/pose_covariance.hpp>
#include <planemap/scan.hpp>
#include <string>
#include <vector>

#include "config/service_config.hpp"
#include "sync/pose_buffer.hpp"

namespace planemap::service {

/// A scan with its place in the world, ready to be mapped.
struct RegisteredScan {
  std::size_t input = 0;  ///< number of the sensor in the configuration
  Scan scan;
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
  std::optional<PoseCovariance> pose_covariance{};  ///< of T_world_sensor; empty: its poses state none
  /// Of the map that it belongs to: grows by one where a jump of the pose begins a new map (pose.jump: reset), and is
  /// never less than that of a scan that was handed on before.
  std::uint64_t map_number = 0;
};

/// A scan for which no pose was found.
struct UnplacedScan {
  std::size_t input = 0;
  std::int64_t utime = 0;
  std::string reason;   ///< for the counter: no_pose, pose_gap, pose_jump, before_poses, clock_restart, waiting_full,
                        ///< old_map
  std::string message;  ///< for the log
};

struct SyncResults {
  std::vector<RegisteredScan> ready;  ///< of each input in the order of arrival
  std::vector<UnplacedScan> dropped;
};

/// Finds the pose of each scan. A scan waits for the pose that comes after it: until max_wait_s have passed on the
/// host's clock, or the same sensor's scans have gone on by max_wait_s in message time, whichever is first. Where a
/// sensor's clock steps back by more than restart_s before that of its poses does, its scans wait as long for the poses
/// to follow: those that are there may be of the run before. Time comes in as an argument and there is no thread in
/// here, so recorded data give the same result every time. Not thread-safe.
class Synchronizer {
 public:
  explicit Synchronizer(const ServiceConfig& config);

  /// The number under which poses of a channel come in; inputs of the same pose channel share it.
  std::size_t stream_of(std::size_t input) const { return inputs_[input].stream; }
  std::size_t stream_count() const { return streams_.size(); }
  const PoseBuffer& poses(std::size_t stream) const { return streams_[stream].poses; }

  PoseInsert add_pose(std::size_t stream, const StampedPose& pose);
  /// @param host_s  the host's steady clock, seconds
  void add_scan(std::size_t input, Scan scan, double host_s);

  /// What can be decided now.
  SyncResults take_ready(double host_s);
  /// The end of the recording: nothing more will come, so nothing waits any longer.
  SyncResults finish();

  std::size_t waiting(std::size_t input) const { return inputs_[input].waiting.size(); }
  std::size_t waiting_bytes() const { return waiting_bytes_; }

 private:
  struct Waiting {
    Scan scan;
    std::int64_t utime = 0;
    double since_host_s = 0.0;
    std::size_t bytes = 0;
    std::uint64_t run = 0;
  };
  struct Stream {
    PoseBuffer poses;
    std::uint64_t jumps = 0;  ///< of the poses until the newest scan that was handed on
  };
  struct Input {
    std::string pose_channel;
    std::size_t stream = 0;
    Eigen::Isometry3d T_body_sensor = Eigen::Isometry3d::Identity();
    std::deque<Waiting> waiting;  ///< in the order of arrival
    // A run ends where the clock steps back.
    std::uint64_t run = 0;             ///< of the newest scan
    std::int64_t run_begin_utime = 0;  ///< first scan of the run
    std::int64_t newest_utime = 0;     ///< of the run
    std::uint64_t posed_run = 0;       ///< scans of later runs wait for the poses' own restart
  };

  void decide(std::size_t index, double host_s, bool at_end, SyncResults& results);
  void hand_on(std::size_t index, const PoseLookup& lookup, SyncResults& results);
  bool has_expired(const Input& input, const Waiting& scan, double host_s) const;
  void drop_front(std::size_t index, const char* reason, std::string message, std::vector<UnplacedScan>& dropped);
  void drop_old_run(std::size_t stream, std::int64_t restart_utime);
  bool is_of_old_run(const Input& input, const Waiting& scan, std::int64_t restart_utime) const;
  std::string describe(const Input& input, std::int64_t utime, const PoseLookup& lookup) const;
  Waiting pop_front(Input& input);

  PoseConfig config_;
  std::int64_t restart_us_;
  std::size_t max_waiting_bytes_;
  std::vector<Stream> streams_;
  std::vector<Input> inputs_;
  std::vector<UnplacedScan> dropped_early_;  ///< by add_scan and add_pose, told by the next take_ready
  std::size_t waiting_bytes_ = 0;
  std::uint64_t map_number_ = 0;
  bool map_is_empty_ = true;  ///< nothing was handed on yet
};

}  // namespace planemap::service

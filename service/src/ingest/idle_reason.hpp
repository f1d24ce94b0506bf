#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace planemap::service {

/// What is known of one input, as far as it explains why nothing is mapped. Host times are of the steady clock,
/// seconds.
struct InputFacts {
  std::string channel;
  std::string pose_channel;
  std::int64_t scans = 0;      ///< good ones
  std::int64_t poses = 0;      ///< good ones, of its pose channel
  std::int64_t waiting = 0;    ///< for a pose
  std::int64_t handed_on = 0;  ///< scans with a pose, to the mapper's queue
  double last_scan_host_s = 0.0;
  double last_pose_host_s = 0.0;
  double last_handed_on_host_s = 0.0;
  std::string last_problem;  ///< why the last scan that was not mapped was not; empty: none
  double last_problem_host_s = 0.0;
  std::string last_pose_problem;  ///< why the last pose that could not be used could not
  double last_pose_problem_host_s = 0.0;
  std::string last_left_out;  ///< why the last scan that was left out on purpose was
  double last_left_out_host_s = 0.0;
};

/// What is known of the mapper and of its queue.
struct MapperFacts {
  std::int64_t mapped = 0;  ///< scans
  double last_mapped_host_s = 0.0;
  std::size_t queued = 0;                     ///< scans that wait for it
  std::size_t queue_capacity = 0;             ///< queue.scans
  std::optional<double> busy_since_host_s{};  ///< when it took the scan at hand; empty: none is
  std::int64_t dropped_from_full_queue = 0;   ///< scans
  double last_dropped_host_s = 0.0;
  std::string last_error{};  ///< why the last scan that it failed at could not be mapped; empty: none
  double last_error_host_s = 0.0;
  bool is_paused = false;
  std::optional<double> reset_host_s{};  ///< when the map was begun anew on demand; empty: never
};

/// Nothing was mapped for so long: idle. Slow sensors of one scan in two seconds are not.
constexpr double kIdleAfterS = 3.0;

/// Why nothing is being mapped, in words: what keeps the mapper, then by input what keeps its scans from the mapper.
/// Empty while scans are mapped.
std::string idle_reason(std::span<const InputFacts> inputs, const MapperFacts& mapper, double now_host_s);

}  // namespace planemap::service

#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace planemap::service {

/// What is known of one input, as far as it explains why nothing is mapped. Host times are of the steady clock,
/// seconds.
struct InputFacts {
  std::string channel;
  std::string pose_channel;
  std::int64_t scans = 0;    ///< good ones
  std::int64_t poses = 0;    ///< good ones, of its pose channel
  std::int64_t waiting = 0;  ///< for a pose
  double last_scan_host_s = 0.0;
  double last_pose_host_s = 0.0;
  std::string last_problem;  ///< why the last scan that was not mapped was not; empty: none
  double last_problem_host_s = 0.0;
  std::string last_pose_problem;  ///< why the last pose that could not be used could not
  double last_pose_problem_host_s = 0.0;
};

/// What is known of the mapper.
struct MapperFacts {
  std::int64_t mapped = 0;  ///< scans
  double last_mapped_host_s = 0.0;
};

/// Nothing was mapped for so long: idle. Slow sensors of one scan in two seconds are not.
constexpr double kIdleAfterS = 3.0;

/// Why nothing is being mapped, in words and by input; empty while scans are mapped.
std::string idle_reason(std::span<const InputFacts> inputs, const MapperFacts& mapper, double now_host_s);

}  // namespace planemap::service

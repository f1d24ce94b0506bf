#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <planemap/sources/frame_source.hpp>
#include <string>
#include <vector>

#include "latency/latency_meter.hpp"

namespace planemap::benchmark {

struct LatencyConfig {
  double rate_hz = 30.0;
  double pose_rate_hz = 100.0;
  std::size_t scans = 900;            ///< to send; the frames forth and back, as often as it takes
  bool compressed = false;            ///< zlib instead of raw
  std::vector<std::string> daemon;    ///< command that starts planemapd, without the options of the run
  std::string url;                    ///< of LCM
  std::vector<std::string> settings;  ///< further KEY=VALUE for the daemon
};

struct LatencyResult {
  std::size_t sent = 0;
  std::size_t late = 0;  ///< scans that went out more than half a period after their time
  std::size_t heard = 0;
  std::size_t deltas = 0;
  std::vector<ScanLatency> scans;
  std::map<std::string, std::int64_t> counters;  ///< the daemon's, at the end
  double scan_ms_p50 = 0.0;                      ///< the daemon's own words about its last 100 scans
  double scan_ms_max = 0.0;
  std::int64_t planes = 0;
  double daemon_cpu = 0.0;  ///< share of its core that the daemon took

  std::int64_t counter(const std::string& name) const;
  std::int64_t counters_beginning(const std::string& prefix) const;
};

/// Starts the daemon, sends it the frames, and listens to what it says; on the network that the process is in. Throws
/// std::runtime_error where the daemon does not come up or goes away.
LatencyResult run_latency(const LatencyConfig& config, const std::vector<sources::Frame>& frames);

}  // namespace planemap::benchmark

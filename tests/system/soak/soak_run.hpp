#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace planemap::system_test {

struct SoakConfig {
  double minutes = 60.0;
  double warm_up_minutes = 20.0;      ///< what is looked at before does not count for the trends
  double rate_hz = 30.0;              ///< of the scans
  int tour_scans = 300;               ///< of one tour through the apartment; then the next one begins
  unsigned seed = 1;                  ///< of the apartment, and of what the clients do
  std::vector<std::string> settings;  ///< further KEY=VALUE for the daemon
};

/// The daemon at one moment.
struct SoakSample {
  double at_s = 0.0;        ///< since the first scan was mapped
  double resident_b = 0.0;  ///< memory of the process
  double heap_b = 0.0;      ///< of it what the program holds, not what the allocator keeps for later
  std::int64_t cells = 0;
  std::int64_t scans = 0;  ///< that were mapped
};

struct SoakResult {
  std::vector<SoakSample> samples;
  std::int64_t sent = 0;                         ///< scans
  std::map<std::string, std::int64_t> counters;  ///< the daemon's, at the end
  std::map<std::string, std::int64_t> visits;    ///< by kind of client
  std::vector<std::string> complaints;           ///< of clients
  int daemon_exit_code = -1;
};

/// Runs the daemon with a map file, the simulated Kinect on an endless tour, and clients that come and go, in the
/// network namespace that the process is in.
/// @param progress  told each sample
/// @throws std::runtime_error where the daemon or the Kinect does not come up or goes away
SoakResult run_soak(const SoakConfig& config, const std::function<void(const SoakSample&)>& progress);

}  // namespace planemap::system_test

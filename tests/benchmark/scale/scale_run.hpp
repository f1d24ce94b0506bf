#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <planemap/config.hpp>
#include <vector>

namespace planemap::benchmark {

struct ScaleConfig {
  std::size_t scans = 20'000;
  std::size_t window = 1000;  ///< scans that a row is about
  std::uint64_t seed = 1;     ///< of the building
  double minutes = 1e9;       ///< after these no window is begun any more
  int shrink = 1;             ///< images are 640 / shrink pixels wide
  double time_lapse = 18.0;   ///< of the robot; at 18 it comes by some 0.5 square metres of floor a scan
  MapperConfig mapper;
};

/// What was measured over some scans. Times are milliseconds.
struct ScaleWindow {
  std::size_t scans = 0;  ///< mapped at its end
  double area_m2 = 0.0;   ///< floor of the rooms that were seen
  std::size_t cells = 0;  ///< stored
  std::size_t blocks = 0;
  std::size_t planes = 0;
  double rss_mb = 0.0;  ///< what the process takes, less what it took before the first scan

  double scan_ms = 0.0;  ///< median, with the snapshot
  double scan_p95_ms = 0.0;
  double own_ms = 0.0;      ///< median of the mapper's thread's own time
  double publish_ms = 0.0;  ///< median: making the snapshot and putting it where readers find it
  double publish_p95_ms = 0.0;
  double publish_own_ms = 0.0;  ///< median, own time
  double publish_own_max_ms = 0.0;
  double take_ms = 0.0;  ///< median: a reader on another thread takes the newest snapshot
  double take_p95_ms = 0.0;
  double take_max_ms = 0.0;
  /// Over the scans for which there is a twin: a map of the last 100 to 250 scans alone, some 100 m2, that took the
  /// same scans in turn with the large one.
  double twin_own_ms = 0.0;       ///< median
  double with_twin_own_ms = 0.0;  ///< median of the large map's over the same scans

  /// Large map to twin, by the thread's own time. 0: there was no twin in this window
  double ratio() const { return twin_own_ms > 0.0 ? with_twin_own_ms / twin_own_ms : 0.0; }
};

/// Maps an endless building. Frames are rendered between the timings, some at a time.
/// @param on_window  told of each window as it ends
std::vector<ScaleWindow> run_scale(const ScaleConfig& config, const std::function<void(const ScaleWindow&)>& on_window);

}  // namespace planemap::benchmark

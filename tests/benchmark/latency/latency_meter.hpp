#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace planemap::benchmark {

/// What was measured of one scan, milliseconds.
struct ScanLatency {
  std::int64_t utime = 0;  ///< of the scan, microseconds
  double wait_ms = 0.0;    ///< from the scan's arrival to that of the pose after it; 0: the pose was there first
  double delta_ms = 0.0;   ///< from the later of the two to the last page of the delta that has the scan in it
  bool alone = false;      ///< the delta is of this scan; else it is of a later one, and tells of both
};

/// Puts together what was heard on the bus. A scan is in the first delta whose utime, that of the newest mapped scan,
/// is not before the scan's own. All utimes are of the messages, all arrivals of one clock, in microseconds.
class LatencyMeter {
 public:
  void scan_arrived(std::int64_t utime, std::int64_t arrival_us) { scans_[utime] = arrival_us; }
  void pose_arrived(std::int64_t utime, std::int64_t arrival_us) { poses_[utime] = arrival_us; }
  /// A page; the delta has arrived with the last one of them. Pages that come twice count once.
  void page_arrived(std::int64_t utime, std::int64_t revision, int page, int page_count, std::int64_t arrival_us);

  std::size_t scans() const { return scans_.size(); }    ///< that were heard
  std::size_t deltas() const { return deltas_.size(); }  ///< that were heard whole
  /// Whether the newest scan that was heard is in a delta.
  bool is_up_to_date() const;
  /// Of each scan that is in a delta and has a pose at or after it, by utime.
  std::vector<ScanLatency> latencies() const;

 private:
  std::map<std::int64_t, std::int64_t> scans_;   ///< arrivals by utime
  std::map<std::int64_t, std::int64_t> poses_;   ///< the same
  std::map<std::int64_t, std::int64_t> deltas_;  ///< the same, of the first whole delta of that utime
  std::map<std::int64_t, std::set<int>> pages_;  ///< of deltas that are not whole yet, by revision
};

}  // namespace planemap::benchmark

#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <planemap/scan.hpp>
#include <string>
#include <string_view>

namespace planemap::service {

/// Counters by name, for instance "scans.dropped.no_pose".
using CounterValues = std::map<std::string, std::int64_t>;

/// Where scans and other things went. Safe from any thread. At every instant
/// scans.received = scans.mapped + scans.waiting + the sum of scans.dropped.* + the sum of scans.rejected.*.
class Counters {
 public:
  Counters();

  void scan_received();                                    ///< a message on a scan channel; it waits from now on
  void scan_mapped(const PointCounts& points);             ///< one that waited is in the map
  void scan_dropped(const std::string& reason);            ///< a good one that waited will not be mapped
  void scan_rejected(const std::string& reason);           ///< one that waited turned out to be unusable
  void add(const std::string& name, std::int64_t by = 1);  ///< anything else
  void set(const std::string& name, std::int64_t value);   ///< for counts that are kept elsewhere

  CounterValues values() const;                       ///< all of them, at one instant
  std::int64_t value(const std::string& name) const;  ///< 0 where nothing of that name was counted

 private:
  void scan_leaves(std::string_view name);
  /// Its count, from 0 where nothing of that name was counted yet; then only does it allocate.
  std::int64_t& count_of(std::string_view name);

  mutable std::mutex mutex_;
  std::map<std::string, std::int64_t, std::less<>> values_;  ///< looked up without making a string
};

}  // namespace planemap::service

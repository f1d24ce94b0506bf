#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "config/service_config.hpp"
#include "mapping/mapping_service.hpp"

namespace planemap::service {

/// Where the sensor was when a scan was taken.
struct SensorPose {
  std::int64_t utime = 0;  ///< microseconds
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
};

/// What was mapped last: the sensor's path, and while somebody looks a thinned copy of the scan. Told by the mapper's
/// thread, which spends a few microseconds on the path and some tens on the scan; read from any.
class LiveView {
 public:
  static constexpr std::size_t kScanPoints = 5000;  ///< of a thinned scan at most
  static constexpr std::size_t kPathPoses = 2000;   ///< of the path at most

  explicit LiveView(const SensorConfig& sensor) : sensor_(sensor) { path_.reserve(kPathPoses); }

  /// On the mapper's thread.
  void on_mapped(const MappedScan& mapped);
  /// Scans are to be copied for so long from now on.
  void want_scans(double for_s);

  /// The body of /api/v1/scan; nullptr: there is none.
  std::shared_ptr<const std::string> scan_blob() const;
  /// {"poses": [...]}, newest last.
  std::string path_json() const;
  /// Where the last mapped scan was taken; empty: none was.
  std::optional<SensorPose> last_pose() const;

 private:
  const SensorConfig sensor_;
  std::atomic<double> wanted_until_s_ = 0.0;  ///< the host's steady clock

  mutable std::mutex mutex_;  ///< of what follows
  std::uint64_t epoch_ = 0;
  std::vector<SensorPose> path_;  ///< every stride_-th pose of the map
  std::size_t stride_ = 1;
  std::size_t poses_ = 0;  ///< of the map, those that were thinned out, too
  std::optional<SensorPose> last_;
  std::shared_ptr<const std::string> scan_;
};

/// Every so-many-th point of a scan in the world frame, as the body of /api/v1/scan: at most LiveView::kScanPoints.
std::string scan_blob_of(const Scan& scan, const Eigen::Isometry3d& T_world_sensor, const SensorConfig& sensor);

}  // namespace planemap::service

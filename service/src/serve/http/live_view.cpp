#include "serve/http/live_view.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "common/byte_stream.hpp"

namespace planemap::service {
namespace {

constexpr std::uint32_t kMagic = 0x534D4C50;  // "PLMS"
constexpr std::uint32_t kVersion = 1;

using Visit = std::function<void(const Eigen::Vector3f&)>;

void visit_points(const DepthScan& scan, const SensorConfig& sensor, const Visit& visit) {
  const auto& k = scan.intrinsics;
  const double pixels = static_cast<double>(k.width) * k.height;
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / LiveView::kScanPoints))));
  for (int v = step / 2; v < k.height; v += step) {
    for (int u = step / 2; u < k.width; u += step) {
      const std::uint16_t depth = scan.depth[static_cast<std::size_t>(v) * k.width + u];
      if (depth == kNoReturn || depth == kNoReturnHigh) continue;
      const double z_m = depth * scan.depth_scale_m;
      if (z_m < sensor.min_range_m || z_m > sensor.max_range_m) continue;
      visit(Eigen::Vector3d((u - k.cx) * z_m / k.fx, (v - k.cy) * z_m / k.fy, z_m).cast<float>());
    }
  }
}

void visit_points(const PointScan& scan, const SensorConfig&, const Visit& visit) {
  const std::size_t count = scan.xyz_m.size() / 3;
  const std::size_t step = count / LiveView::kScanPoints + 1;
  for (std::size_t i = 0; i < count; i += step) {
    const Eigen::Vector3f point = Eigen::Map<const Eigen::Vector3f>(&scan.xyz_m[3 * i]);
    if (point.allFinite()) visit(point);
  }
}

std::string json_of(const SensorPose& pose) {
  const Eigen::Vector3d& p = pose.T_world_sensor.translation();
  const Eigen::Quaterniond q(pose.T_world_sensor.linear());
  return fmt::format("[{},{},{},{},{:.6f},{:.6f},{:.6f},{:.6f}]", pose.utime, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(),
                     q.z());
}

}  // namespace

std::string scan_blob_of(const Scan& scan, const Eigen::Isometry3d& T_world_sensor, const SensorConfig& sensor) {
  const Eigen::Isometry3f T = T_world_sensor.cast<float>();
  ByteWriter<std::string> out;
  out.bytes().reserve(24 + 12 * LiveView::kScanPoints);
  out.put(kMagic);
  out.put(kVersion);
  out.put(utime_of(scan));
  const std::size_t count_at = out.size();
  out.put(std::uint32_t{0});
  out.put(std::uint32_t{0});
  std::uint32_t count = 0;
  const auto put = [&](const Eigen::Vector3f& p_sensor_m) {
    if (count >= LiveView::kScanPoints) return;  // the edges of a picture may have a row more
    const Eigen::Vector3f p_world_m = T * p_sensor_m;
    for (const float x : p_world_m) out.put(x);
    ++count;
  };
  std::visit([&](const auto& points) { visit_points(points, sensor, put); }, scan);
  out.patch(count_at, count);
  return std::move(out.bytes());
}

void LiveView::on_mapped(const MappedScan& mapped) {
  std::shared_ptr<const std::string> scan;
  if (steady_now_s() < wanted_until_s_) {
    scan = std::make_shared<const std::string>(scan_blob_of(mapped.scan.scan, mapped.scan.T_world_sensor, sensor_));
  }
  const SensorPose pose{utime_of(mapped.scan.scan), mapped.scan.T_world_sensor};
  const std::lock_guard lock(mutex_);
  if (mapped.epoch != epoch_) {
    epoch_ = mapped.epoch;
    path_.clear();
    stride_ = 1;
    poses_ = 0;
  }
  last_ = pose;
  scan_ = std::move(scan);
  if (poses_++ % stride_ != 0) return;
  path_.push_back(pose);
  if (path_.size() < kPathPoses) return;
  for (std::size_t i = 0; 2 * i < path_.size(); ++i) path_[i] = path_[2 * i];
  path_.resize((path_.size() + 1) / 2);
  stride_ *= 2;
}

void LiveView::want_scans(double for_s) {
  wanted_until_s_ = steady_now_s() + for_s;
}

std::shared_ptr<const std::string> LiveView::scan_blob() const {
  const std::lock_guard lock(mutex_);
  return scan_;
}

std::optional<SensorPose> LiveView::last_pose() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

std::string LiveView::path_json() const {
  std::vector<SensorPose> path;
  {
    const std::lock_guard lock(mutex_);
    path = path_;
    if (last_ && (path.empty() || path.back().utime != last_->utime)) path.push_back(*last_);
  }
  std::string text = R"({"poses":[)";
  const char* separator = "";
  for (const SensorPose& pose : path) {
    text += separator + json_of(pose);
    separator = ",\n";
  }
  return text + "]}\n";
}

}  // namespace planemap::service

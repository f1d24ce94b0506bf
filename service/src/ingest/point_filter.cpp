#include "ingest/point_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace planemap::service {
namespace {

/// Farther to the side than any sensor sees; keeps points within the grid's integers.
constexpr float kMaxLateralM = 1e5F;

/// The least and greatest raw depths within the limits, so that the loop over the pixels compares integers.
struct RawLimits {
  double least;
  double greatest;
};
RawLimits raw_limits(double min_range_m, double max_range_m, double depth_scale_m) {
  return {std::ceil(min_range_m / depth_scale_m), std::floor(max_range_m / depth_scale_m)};
}

}  // namespace

PointFilter::PointFilter(const InputConfig& input) : min_range_m_(input.min_range_m), max_range_m_(input.max_range_m) {
  const auto& q = input.rotation_wxyz;
  T_body_sensor_.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  T_body_sensor_.translation() = Eigen::Map<const Eigen::Vector3d>(input.translation_m.data());
  for (const auto& box : input.body_mask) {
    boxes_.emplace_back(Eigen::Map<const Eigen::Vector3d>(box.min_m.data()),
                        Eigen::Map<const Eigen::Vector3d>(box.max_m.data()));
  }
}

FilteredPoints PointFilter::apply(Scan& scan) const {
  return std::visit([this](auto& s) { return apply(s); }, scan);
}

FilteredPoints PointFilter::apply(DepthScan& scan) const {
  FilteredPoints filtered;
  const RawLimits limits = raw_limits(min_range_m_, max_range_m_, scan.depth_scale_m);
  if (limits.least > 1.0 || limits.greatest < kNoReturnHigh - 1) {
    for (std::uint16_t& depth : scan.depth) {
      if (depth == kNoReturn || depth == kNoReturnHigh || (depth >= limits.least && depth <= limits.greatest)) continue;
      depth = kNoReturn;
      ++filtered.out_of_range;
    }
  }
  if (!boxes_.empty()) filtered.own_body = mask_depth(scan);
  return filtered;
}

std::size_t PointFilter::mask_depth(DepthScan& scan) const {
  const auto& camera = scan.intrinsics;
  std::size_t masked = 0;
  std::uint16_t* depth = scan.depth.data();
  for (int v = 0; v < camera.height; ++v) {
    const double slope_y = (v - camera.cy) / camera.fy;
    for (int u = 0; u < camera.width; ++u, ++depth) {
      if (*depth == kNoReturn || *depth == kNoReturnHigh) continue;
      const double z_m = *depth * scan.depth_scale_m;
      if (!on_body({(u - camera.cx) / camera.fx * z_m, slope_y * z_m, z_m})) continue;
      *depth = kNoReturn;
      ++masked;
    }
  }
  return masked;
}

FilteredPoints PointFilter::apply(PointScan& scan) const {
  FilteredPoints filtered;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i + 2 < scan.xyz_m.size(); i += 3) {
    float* p = &scan.xyz_m[i];
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
    const bool in_range = p[2] >= min_range_m_ && p[2] <= max_range_m_ && std::abs(p[0]) <= kMaxLateralM &&
                          std::abs(p[1]) <= kMaxLateralM;
    if (in_range && !on_body(Eigen::Map<const Eigen::Vector3f>(p).cast<double>())) continue;
    ++(in_range ? filtered.own_body : filtered.out_of_range);
    std::fill_n(p, 3, kNone);
  }
  return filtered;
}

bool PointFilter::on_body(const Eigen::Vector3d& p_sensor_m) const {
  if (boxes_.empty()) return false;
  const Eigen::Vector3d p_body_m = T_body_sensor_ * p_sensor_m;
  return std::any_of(boxes_.begin(), boxes_.end(), [&](const auto& box) { return box.contains(p_body_m); });
}

}  // namespace planemap::service

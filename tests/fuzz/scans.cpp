#include "scans.hpp"

#include <cmath>
#include <planemap/mapper.hpp>

#include "memory_bound.hpp"

namespace planemap::fuzz {
namespace {

/// zlib's and libpng's own state beside the pixels.
constexpr std::size_t kUnpacking = std::size_t{256} << 10;

/// A pose whose numbers come from the message, so that points fall anywhere.
Eigen::Isometry3d pose_of(const Bytes& message) {
  const double angle_rad = message.size() < 20 ? 0.0 : message[19] / 40.0;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.rotate(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  T.pretranslate(Eigen::Vector3d(angle_rad, -2.0 * angle_rad, 1.0));
  return T;
}

}  // namespace

service::ScanFormat full_format() {
  service::ScanFormat format;
  format.intrinsics = PinholeIntrinsics{0, 0, 75.0, 75.0, 40.0, 30.0};
  format.disparity = service::DisparityCalibration{0.075, 1090.0};
  return format;
}

void decode_and_map(const Bytes& message, Packing packing, const service::ScanFormat& format) {
  const std::size_t most =
      decoding_bound(message.size()) + (packing == Packing::kRaw ? 0 : 2 * kImageBytes + kUnpacking);
  const MemoryBound bound(most);
  const auto scan = service::decode_scan(message, kImageBytes, format);
  bound.check("decode_scan");
  if (!scan) {
    require(!scan.error().reason.empty() && !scan.error().message.empty(), "a rejection without words");
    return;
  }
  Mapper mapper(preset(Preset::kBest), /*epoch=*/1);
  const auto report = mapper.integrate(scan->scan, pose_of(message));
  const PointCounts& points = report.points;
  require(points.total == points.mapped + points.no_return + points.out_of_range + points.invalid,
          "points were lost in the count");
  for (const auto& plane : mapper.snapshot()->planes()) {
    require(plane->plane.normal().allFinite() && std::isfinite(plane->plane.d()) && plane->centroid_m.allFinite(),
            "a plane that is not finite");
  }
}

}  // namespace planemap::fuzz

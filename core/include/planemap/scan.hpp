#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace planemap {

/// Pinhole camera without distortion: u = fx * x / z + cx, v = fy * y / z + cy; pixel centres have whole coordinates.
struct PinholeIntrinsics {
  int width = 0;    ///< pixels
  int height = 0;   ///< pixels
  double fx = 0.0;  ///< pixels
  double fy = 0.0;  ///< pixels
  double cx = 0.0;  ///< pixels
  double cy = 0.0;  ///< pixels

  bool operator==(const PinholeIntrinsics&) const = default;
};

constexpr std::uint16_t kNoReturn = 0;          ///< Depth of a pixel that saw nothing.
constexpr std::uint16_t kNoReturnHigh = 65535;  ///< The same, as some drivers write it.

/// One depth image. Sensor frame: x right, y down, z forward; depth is along z.
struct DepthScan {
  std::int64_t utime = 0;  ///< microseconds, time of acquisition
  PinholeIntrinsics intrinsics;
  double depth_scale_m = 0.001;      ///< metres per unit of depth
  std::vector<std::uint16_t> depth;  ///< row-major, width * height; kNoReturn and kNoReturnHigh are no returns
};

/// One point cloud in the sensor frame.
struct PointScan {
  std::int64_t utime = 0;      ///< microseconds, time of acquisition
  std::vector<float> xyz_m;    ///< x0 y0 z0 x1 y1 z1 ...; a point that is not finite is no return
  std::vector<float> sigma_m;  ///< standard errors along x, y, z, laid out as xyz_m; empty: the sensor model gives them
};

using Scan = std::variant<DepthScan, PointScan>;

inline std::int64_t utime_of(const Scan& scan) {
  return std::visit([](const auto& s) { return s.utime; }, scan);
}

/// Where a scan's points went; total = mapped + no_return + out_of_range + invalid.
struct PointCounts {
  std::size_t total = 0;
  std::size_t mapped = 0;
  std::size_t no_return = 0;     ///< nothing was seen there
  std::size_t out_of_range = 0;  ///< outside the sensor's range limits
  std::size_t invalid = 0;       ///< standard errors that are negative or not finite

  PointCounts& operator+=(const PointCounts& other) {
    total += other.total;
    mapped += other.mapped;
    no_return += other.no_return;
    out_of_range += other.out_of_range;
    invalid += other.invalid;
    return *this;
  }
  bool operator==(const PointCounts&) const = default;
};

}  // namespace planemap

#include "planemap/range_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace planemap {

namespace {

/// Samples along an edge of a tile of a depth image, about: every second pixel of a Kinect's.
constexpr int kSamplesPerEdge = 4;

/// With fewer returns a tile of a point cloud says nothing: who knows where the sensor looked.
constexpr std::uint32_t kLeastReturns = 3;

/// Points of a cloud that are read at most; they bound the work.
constexpr std::size_t kCloudPoints = 25000;

/// Tiles along an edge of the view that a point cloud is projected into: up to 45 degrees from the axis.
constexpr int kCloudTiles = 2 * static_cast<int>(RangeTiles::kPerUnit);

}  // namespace

void RangeTiles::read(const Scan& scan) {
  if (const auto* depth = std::get_if<DepthScan>(&scan)) {
    read_depth(*depth);
  } else {
    read_cloud(std::get<PointScan>(scan));
  }
  farthest_m_ = 0.0F;
  seen_.setEmpty();
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) {
      if (is_silent(u, v)) continue;
      farthest_m_ = std::max(farthest_m_, nearest_m(u, v));
      seen_.extend(Eigen::Vector2i(u, v));
    }
  }
}

void RangeTiles::read_depth(const DepthScan& scan) {
  const PinholeIntrinsics& k = scan.intrinsics;
  const double widest_px = std::max(1, std::max(k.width, k.height));
  const int tile_px = static_cast<int>(std::clamp(std::round(k.fx / kPerUnit), 1.0, widest_px));
  const int step = std::max(1, tile_px / kSamplesPerEdge);
  width_ = (k.width + tile_px - 1) / tile_px;
  height_ = (k.height + tile_px - 1) / tile_px;
  fx_ = k.fx / tile_px;
  fy_ = k.fy / tile_px;
  cx_ = (k.cx + 0.5) / tile_px;  // a pixel's centre has whole coordinates, its border is half a pixel before
  cy_ = (k.cy + 0.5) / tile_px;
  signed_m_.clear();
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) signed_m_.push_back(signed_m(scan, u, v, tile_px, step));
  }
}

float RangeTiles::signed_m(const DepthScan& scan, int tile_u, int tile_v, int tile_px, int step) const {
  const int u_end = std::min((tile_u + 1) * tile_px, scan.intrinsics.width);
  const int v_end = std::min((tile_v + 1) * tile_px, scan.intrinsics.height);
  // Minus one, both marks of no return are greater than any depth.
  constexpr std::uint16_t kNone = kNoReturnHigh - 1;
  std::uint16_t nearest = kNone;
  std::uint32_t returns = 0;
  std::uint32_t samples = 0;
  for (int v = tile_v * tile_px; v < v_end; v += step) {
    const std::uint16_t* row = scan.depth.data() + static_cast<std::size_t>(v) * scan.intrinsics.width;
    for (int u = tile_u * tile_px; u < u_end; u += step) {
      const auto depth = static_cast<std::uint16_t>(row[u] - 1U);
      nearest = std::min(nearest, depth);
      returns += depth < kNone ? 1U : 0U;
      ++samples;
    }
  }
  // A pixel without return may hide what the tile is asked about; a few come with every edge.
  const bool known = returns > 0 && 4 * returns >= 3 * samples;
  if (returns == 0) return -std::numeric_limits<float>::infinity();
  const auto depth_m = static_cast<float>((nearest + 1.0) * scan.depth_scale_m);
  return known ? depth_m : -depth_m;
}

void RangeTiles::read_cloud(const PointScan& scan) {
  width_ = height_ = kCloudTiles;
  fx_ = fy_ = kPerUnit;
  cx_ = cy_ = 0.5 * kCloudTiles;
  const std::size_t tiles = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  signed_m_.assign(tiles, std::numeric_limits<float>::infinity());
  returns_.assign(tiles, 0);
  const std::size_t size = scan.xyz_m.size() / 3;
  const std::size_t step = 1 + size / kCloudPoints;
  constexpr auto kScale = static_cast<float>(kPerUnit);
  constexpr float kHalf = 0.5F * kCloudTiles;
  for (std::size_t i = 0; i < size; i += step) {
    const float* p = &scan.xyz_m[3 * i];
    if (!(p[2] > 0.0F)) continue;
    const float u = kScale * p[0] / p[2] + kHalf;
    const float v = kScale * p[1] / p[2] + kHalf;
    if (!(u >= 0.0F && u < 2.0F * kHalf && v >= 0.0F && v < 2.0F * kHalf)) continue;
    const std::size_t tile = static_cast<std::size_t>(v) * kCloudTiles + static_cast<std::size_t>(u);
    signed_m_[tile] = std::min(signed_m_[tile], p[2]);
    ++returns_[tile];
  }
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    if (returns_[tile] < kLeastReturns) signed_m_[tile] = -signed_m_[tile];
  }
}

}  // namespace planemap

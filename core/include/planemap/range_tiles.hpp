#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <planemap/scan.hpp>
#include <vector>

namespace planemap {

/// A scan as a coarse range image: for each small tile of it, how far its rays went before they met anything.
///
/// A tile's depth is the least one measured in it, so nothing in the tile is nearer. Tiles are about 0.9 degrees wide;
/// a depth image is cut into squares of pixels, a point cloud is projected into a view of 90 by 90 degrees about the
/// sensor's axis. Not every pixel or point is read: enough to see whatever is wider than two pixels.
class RangeTiles {
 public:
  /// Tiles for each unit of x / z.
  static constexpr double kPerUnit = 64.0;

  void read(const Scan& scan);

  int width() const { return width_; }    ///< tiles
  int height() const { return height_; }  ///< tiles
  // Where a direction is, in tiles from the image's left and upper border: u = fx x/z + cx, v = fy y/z + cy.
  double fx() const { return fx_; }
  double fy() const { return fy_; }
  double cx() const { return cx_; }
  double cy() const { return cy_; }
  /// Where a point is, sensor frame. @pre its z is not 0
  Eigen::Vector2f place_of(const Eigen::Vector3f& p_sensor_m) const {
    const float per_z = 1.0F / p_sensor_m.z();
    return {static_cast<float>(fx_) * p_sensor_m.x() * per_z + static_cast<float>(cx_),
            static_cast<float>(fy_) * p_sensor_m.y() * per_z + static_cast<float>(cy_)};
  }
  bool contains(const Eigen::Vector2f& uv) const {
    return uv.x() >= 0.0F && uv.y() >= 0.0F && uv.x() < static_cast<float>(width_) &&
           uv.y() < static_cast<float>(height_);
  }
  /// The ray through a tile's middle, sensor frame, as long as its z is 1.
  Eigen::Vector3f ray_of(int u, int v) const {
    return {(static_cast<float>(u) + 0.5F - static_cast<float>(cx_)) / static_cast<float>(fx_),
            (static_cast<float>(v) + 0.5F - static_cast<float>(cy_)) / static_cast<float>(fy_), 1.0F};
  }

  /// The least depth in a tile, metres along z; infinite where nothing came back. @pre 0 <= u < width(), 0 <= v <
  /// height()
  float nearest_m(int u, int v) const { return std::abs(signed_m_[index(u, v)]); }
  /// Whether too little came back from a tile to say that it holds nothing nearer: a pixel without return may hide
  /// anything.
  bool is_silent(int u, int v) const { return std::signbit(signed_m_[index(u, v)]); }
  float farthest_m() const { return farthest_m_; }  ///< greatest nearest_m() of tiles that are not silent; 0: all are
  /// The tiles that are not silent lie in this box, u and v.
  const Eigen::AlignedBox2i& seen() const { return seen_; }

 private:
  void read_depth(const DepthScan& scan);
  void read_cloud(const PointScan& scan);
  float signed_m(const DepthScan& scan, int tile_u, int tile_v, int tile_px, int step) const;
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
  }

  int width_ = 0;
  int height_ = 0;
  double fx_ = 1.0;
  double fy_ = 1.0;
  double cx_ = 0.0;
  double cy_ = 0.0;
  float farthest_m_ = 0.0F;
  Eigen::AlignedBox2i seen_;
  std::vector<float> signed_m_;         ///< least depths by tile; negative: silent
  std::vector<std::uint32_t> returns_;  ///< of a point cloud, by tile
};

}  // namespace planemap

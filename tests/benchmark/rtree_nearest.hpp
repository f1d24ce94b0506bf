#pragma once

#include <Eigen/Core>
#include <memory>
#include <planemap/described_plane.hpp>
#include <span>

namespace planemap::benchmark {

/// The plane whose surface is nearest to a point, by Boost.Geometry's R-tree: what core's own tree is measured against.
class RtreeNearest {
 public:
  explicit RtreeNearest(std::span<const DescribedPlane> planes);
  ~RtreeNearest();
  RtreeNearest(const RtreeNearest&) = delete;
  RtreeNearest& operator=(const RtreeNearest&) = delete;

  PlaneId nearest(const Eigen::Vector3d& p_world_m) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::benchmark

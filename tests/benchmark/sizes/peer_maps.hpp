#pragma once

#include <cstddef>
#include <memory>

#include "contestant.hpp"

namespace planemap::benchmark {

/// What a peer's map of the frames so far takes.
struct PeerSizes {
  std::size_t octomap_bt_bytes = 0;            ///< occupied and free, one bit each: OctoMap's .bt, pruned
  std::size_t octomap_ot_bytes = 0;            ///< with probabilities: .ot
  std::size_t octomap_endpoints_bt_bytes = 0;  ///< .bt of the end points alone, no rays
  std::size_t voxel_points = 0;                ///< voxels that hold a point; a cloud of them takes 12 bytes each
};

/// OctoMap and a voxel cloud of the same points at one resolution.
class PeerMaps {
 public:
  explicit PeerMaps(double resolution_m);
  ~PeerMaps();
  PeerMaps(const PeerMaps&) = delete;
  PeerMaps& operator=(const PeerMaps&) = delete;

  void add(const BenchFrame& frame);
  PeerSizes sizes();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::benchmark

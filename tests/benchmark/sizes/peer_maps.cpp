#include "sizes/peer_maps.hpp"

#include <octomap/octomap.h>

#include <sstream>

#include "octomap_endpoints.hpp"

namespace planemap::benchmark {

struct PeerMaps::Impl {
  explicit Impl(double resolution_m) : rays(resolution_m), endpoints(resolution_m) {}
  octomap::OcTree rays;
  octomap::OcTree endpoints;
  octomap::KeySet keys;
};

namespace {

std::size_t bt_bytes(octomap::OcTree& tree) {
  tree.updateInnerOccupancy();
  std::ostringstream out;
  tree.writeBinary(out);  // maximum likelihood, and pruned
  return out.str().size();
}

}  // namespace

PeerMaps::PeerMaps(double resolution_m) : impl_(std::make_unique<Impl>(resolution_m)) {}
PeerMaps::~PeerMaps() = default;

void PeerMaps::add(const BenchFrame& frame) {
  octomap::Pointcloud cloud;
  cloud.reserve(frame.xyz_world_m.size() / 3);
  for (std::size_t i = 0; i + 2 < frame.xyz_world_m.size(); i += 3) {
    const float* p = &frame.xyz_world_m[i];
    cloud.push_back(p[0], p[1], p[2]);
  }
  mark_endpoints(frame.xyz_world_m, impl_->keys, impl_->endpoints);
  const Eigen::Vector3f origin = frame.T_world_sensor.translation().cast<float>();
  impl_->rays.insertPointCloud(cloud, octomap::point3d(origin.x(), origin.y(), origin.z()), /*maxrange=*/-1.0,
                               /*lazy_eval=*/true, /*discretize=*/true);
}

PeerSizes PeerMaps::sizes() {
  PeerSizes sizes;
  // Nothing is ever taken from this one: its voxels are those that hold a point.
  impl_->endpoints.expand();
  sizes.voxel_points = impl_->endpoints.getNumLeafNodes();
  sizes.octomap_endpoints_bt_bytes = bt_bytes(impl_->endpoints);
  impl_->rays.updateInnerOccupancy();
  impl_->rays.prune();
  std::ostringstream out;
  impl_->rays.write(out);
  sizes.octomap_ot_bytes = out.str().size();
  sizes.octomap_bt_bytes = bt_bytes(impl_->rays);
  return sizes;
}

}  // namespace planemap::benchmark

#include "serve/plane_book.hpp"

namespace planemap::service {

PlaneBook::PlaneBook(const MapConfig& config) {
  if (config.gravity.size() == 3) gravity_ = Eigen::Map<const Eigen::Vector3d>(config.gravity.data());
}

const std::vector<DescribedPlane>& PlaneBook::describe(const std::shared_ptr<const MapSnapshot>& snapshot) {
  if (snapshot != snapshot_) {
    planes_ = describe_planes(*snapshot, gravity_, planes_);
    snapshot_ = snapshot;
  }
  return planes_;
}

}  // namespace planemap::service

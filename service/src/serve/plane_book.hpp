#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <planemap/described_plane.hpp>
#include <planemap/snapshot.hpp>
#include <vector>

#include "config/service_config.hpp"

namespace planemap::service {

/// Boundaries and classes of a snapshot's planes. A boundary is made anew only when its plane has changed. Not
/// thread-safe.
class PlaneBook {
 public:
  explicit PlaneBook(const MapConfig& config);

  /// All planes of the snapshot, by id. The result stays as it is until the next call.
  const std::vector<DescribedPlane>& describe(const std::shared_ptr<const MapSnapshot>& snapshot);

 private:
  std::optional<Eigen::Vector3d> gravity_;
  std::shared_ptr<const MapSnapshot> snapshot_;  ///< that planes_ describes
  std::vector<DescribedPlane> planes_;
};

}  // namespace planemap::service

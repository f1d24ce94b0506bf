#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <planemap/outline.hpp>
#include <planemap/snapshot.hpp>
#include <unordered_map>
#include <vector>

#include "config/service_config.hpp"

namespace planemap::service {

/// A plane with what is told of it beside its record.
struct DescribedPlane {
  std::shared_ptr<const PlaneRecord> record;
  std::shared_ptr<const Outline> outline;
  PlaneClass plane_class = PlaneClass::kOther;
};

/// Boundaries and classes of a snapshot's planes. A boundary is made anew only when its plane has changed. Not
/// thread-safe.
class PlaneBook {
 public:
  explicit PlaneBook(const MapConfig& config);

  /// All planes of the snapshot, by id. The result stays as it is until the next call.
  const std::vector<DescribedPlane>& describe(const std::shared_ptr<const MapSnapshot>& snapshot);

 private:
  void refresh_outlines(const MapSnapshot& snapshot);
  void refresh_classes();

  std::optional<Eigen::Vector3d> gravity_;
  std::shared_ptr<const MapSnapshot> snapshot_;  ///< that planes_ describes
  std::vector<DescribedPlane> planes_;
};

}  // namespace planemap::service

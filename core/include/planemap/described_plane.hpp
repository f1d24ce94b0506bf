#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <planemap/outline.hpp>
#include <planemap/plane.hpp>
#include <planemap/snapshot.hpp>
#include <span>
#include <vector>

namespace planemap {

/// A plane with what is told of it beside its record.
struct DescribedPlane {
  std::shared_ptr<const PlaneRecord> record;
  std::shared_ptr<const Outline> outline;
  PlaneClass plane_class = PlaneClass::kOther;
};

/// Boundaries and classes of all planes of a snapshot, by id.
/// @param gravity   points down in the world frame, any length but 0; empty: not known, every class is kOther
/// @param previous  what this gave for an earlier snapshot of the same map: a plane whose record is still the same one
///                  keeps its outline, and only the others are made anew
std::vector<DescribedPlane> describe_planes(const MapSnapshot& snapshot, const std::optional<Eigen::Vector3d>& gravity,
                                            std::span<const DescribedPlane> previous = {});

}  // namespace planemap

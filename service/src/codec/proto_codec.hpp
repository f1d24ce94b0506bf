#pragma once

#include <cstdint>
#include <planemap/expected.hpp>
#include <planemap/outline.hpp>
#include <planemap/plane.hpp>
#include <string>
#include <vector>

namespace planemap::v1 {
class Plane;
class Snapshot;
}  // namespace planemap::v1

namespace planemap::service {

/// A plane with everything that is sent of it.
struct ShapedPlane {
  PlaneRecord record;
  PlaneClass plane_class = PlaneClass::kOther;
  Outline outline;
};

/// A map with everything that is sent of it; planes by id.
struct ShapedMap {
  std::string frame;
  std::uint64_t epoch = 0;
  std::uint64_t revision = 0;
  std::int64_t utime = 0;  ///< microseconds, of the newest mapped scan; 0: none
  double cell_size_m = 0.0;
  std::vector<ShapedPlane> planes;
};

/// The plane as planemap.v1 has it. Outlines are rounded to float.
v1::Plane to_proto(const ShapedPlane& plane);
v1::Snapshot to_proto(const ShapedMap& map);

/// The plane of a message from outside. The error names the field and what is wrong with it: a number that is not
/// finite, a normal or a basis that is not orthonormal within 1e-6, a covariance that does not have 10 numbers or a
/// negative variance, a ring of fewer than three points, an id that is 0 or not below 2^53.
Expected<ShapedPlane> from_proto(const v1::Plane& message);

/// The map of a message from outside; beside what is wrong with a plane, planes that are not in the order of their ids.
Expected<ShapedMap> from_proto(const v1::Snapshot& message);

}  // namespace planemap::service

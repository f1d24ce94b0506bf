#pragma once

#include <planemap/v1/planes.pb.h>

#include <Eigen/Core>
#include <planemap/expected.hpp>
#include <planemap/outline.hpp>
#include <planemap/plane.hpp>

namespace planemap::service {

// Pieces of which messages of planemap.v1 are made.

void set(v1::Vector3& message, const Eigen::Vector3d& v);
Eigen::Vector3d vector_of(const v1::Vector3& message);
/// Corners are rounded to float.
void set(v1::Polygon& message, const Polygon& polygon);
/// Fails for a number that names no class.
Expected<PlaneClass> class_of(v1::PlaneClass message);

v1::Plane to_proto(const PlaneRecord& record, PlaneClass plane_class, const Outline& outline);

}  // namespace planemap::service

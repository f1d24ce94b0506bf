#pragma once

#include <Eigen/Geometry>
#include <planemap/plane.hpp>

namespace planemap::testing {

/// A record of a plane through a point that is known there to offset_m and its normal to tilt_rad in either direction.
inline PlaneRecord record_of(PlaneId id, const Eigen::Vector3d& centroid_m, const Eigen::Vector3d& normal,
                             double offset_m, double tilt_rad) {
  PlaneRecord record;
  record.id = id;
  record.plane = Plane::through(centroid_m, normal.normalized());
  record.centroid_m = centroid_m;
  const Eigen::Vector3d t1 = record.plane.normal().unitOrthogonal();
  const Eigen::Vector3d t2 = record.plane.normal().cross(t1);
  Eigen::Matrix<double, 4, 3> of_tilts_and_offset;
  of_tilts_and_offset << t1, t2, Eigen::Vector3d::Zero(), -t1.dot(centroid_m), -t2.dot(centroid_m), 1.0;
  const Eigen::Vector3d variances(tilt_rad * tilt_rad, tilt_rad * tilt_rad, offset_m * offset_m);
  record.covariance = of_tilts_and_offset * variances.asDiagonal() * of_tilts_and_offset.transpose();
  return record;
}

}  // namespace planemap::testing

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <planemap/config.hpp>

namespace planemap {

/// Covariance of the error (t, r) of a pose T: the true one is T (I + [t, r]), t a translation (metres) and r a small
/// rotation (radians), both about the axes of the frame that T places. Rows and columns: t x y z, r x y z.
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

/// The configured one: equal along and about all axes.
PoseCovariance configured_covariance(const PoseErrorConfig& config);

/// Covariance of T_world_sensor = T_world_body T_body_sensor by that of T_world_body; T_body_sensor is exact. The
/// sensor's error is Ad(T_body_sensor^-1) times the body's: the same motion, seen from the sensor.
PoseCovariance covariance_at_sensor(const PoseCovariance& of_body, const Eigen::Isometry3d& T_body_sensor);

/// Lower triangle L with X = L L^T, also where X is singular. Continuous in X, and indifferent to the units.
PoseCovariance cholesky_factor(const PoseCovariance& x);

/// Variance that the errors of a sensor's pose give a point at a usual distance before it, along the direction in which
/// it is greatest.
double point_variance_m2(const PoseCovariance& of_sensor);

/// Of a covariance: along the axis along which it is greatest.
double greatest_variance(const Eigen::Matrix3d& covariance);

}  // namespace planemap

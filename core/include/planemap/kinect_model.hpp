#pragma once

#include <Eigen/Core>
#include <planemap/config.hpp>

namespace planemap {

/// Standard errors of a Kinect-like sensor's points. Khoshelham and Elberink, Sensors 12(2), 2012 (the paper's [21]).
class KinectModel {
 public:
  /// @param focal_length_px  of the depth image; throws std::invalid_argument unless finite and > 0
  KinectModel(const SensorConfig& config, double focal_length_px);

  /// Standard error of a depth reading: the random error sigma_z = k z^2 and the quantisation of the disparity,
  /// z^2 step / (f b sqrt(12)), added as independent errors. Metres. @pre depth_m >= 0
  double sigma_z_m(double depth_m) const { return depth_factor_ * depth_m * depth_m; }

  /// Standard error across the axis: sigma_z in proportion to the offset from the axis, at least the floor of
  /// lateral_floor_px pixels. Metres.
  /// @param offset_m  x or y of the point in the sensor frame
  double sigma_lateral_m(double offset_m, double depth_m) const;

  /// (sigma_x, sigma_y, sigma_z) of a point in the sensor frame, metres.
  Eigen::Vector3d sigma_m(const Eigen::Vector3d& p_sensor_m) const;

  double depth_factor() const { return depth_factor_; }      ///< sigma_z / z^2, 1/m
  double lateral_factor() const { return lateral_factor_; }  ///< floor of sigma_x / z

 private:
  double depth_factor_;
  double lateral_factor_;
};

/// Variances of a point along the world's axes: the diagonal of R diag(sigma^2) R^T.
/// @param R_world_sensor  rotation, sensor to world
Eigen::Vector3d rotate_variances(const Eigen::Matrix3d& R_world_sensor, const Eigen::Vector3d& variance_sensor_m2);

}  // namespace planemap

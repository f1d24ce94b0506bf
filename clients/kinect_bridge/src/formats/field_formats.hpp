#pragma once

#include <bot_core/image_t.hpp>
#include <bot_core/images_t.hpp>
#include <bot_core/pointcloud2_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <drake/lcmt_image_array.hpp>
#include <drake/lcmt_point_cloud.hpp>
#include <kinect/frame_msg_t.hpp>
#include <planemap/scan.hpp>
#include <pronto/rigid_body_pose_cov_t.hpp>

#include "wire.hpp"

namespace planemap::kinect_bridge {

// A scan in the types of other robots' stacks. Depths are millimetres unless a name says otherwise; each has the scan's
// utime.

/// Depth in millimetres.
kinect::frame_msg_t to_kinect_frame(const DepthScan& scan, Encoding encoding);
/// Depth as a Kinect's raw 11-bit disparity, d = kDisparityOffset - 8 fx kDisparityBaselineM / z, rounded; 2047 where
/// nothing was seen.
kinect::frame_msg_t to_kinect_disparity(const DepthScan& scan, Encoding encoding);
constexpr double kDisparityBaselineM = 0.075;
constexpr double kDisparityOffset = 1090.0;

/// Frame of the depth image in an array of images.
constexpr const char* kDepthFrame = "kinect";

/// An empty colour image and the depth.
bot_core::images_t to_images(const DepthScan& scan, Encoding encoding);
/// 16-bit grey, little-endian; the type knows no compression.
bot_core::image_t to_image(const DepthScan& scan);

enum class DrakePixels { kUint16, kFloat32 };
/// An empty colour image and the depth, of the frame "kinect".
/// @param encoding  kPng of 16-bit pixels only
drake::lcmt_image_array to_image_array(const DepthScan& scan, DrakePixels pixels, Encoding encoding);

/// Every pixel as a point of the sensor's frame, in the image's order, NaN where nothing was seen.
bot_core::pointcloud2_t to_pointcloud2(const DepthScan& scan);
/// The same without the points that saw nothing.
drake::lcmt_point_cloud to_point_cloud(const DepthScan& scan);

bot_core::rigid_transform_t to_rigid_transform(const Eigen::Isometry3d& T_world_body, std::int64_t utime);
/// @param sigma_m, sigma_rad  standard errors along and about each axis
pronto::rigid_body_pose_cov_t to_pose_cov(const Eigen::Isometry3d& T_world_body, std::int64_t utime, double sigma_m,
                                          double sigma_rad);

}  // namespace planemap::kinect_bridge

#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/scan.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "wire.hpp"

namespace planemap::kinect_bridge {

/// Types that a scan can be sent as.
enum class ScanType {
  kDepthScan,        ///< planemap_lcm.depth_scan_t
  kKinectFrame,      ///< kinect.frame_msg_t, millimetres
  kKinectDisparity,  ///< kinect.frame_msg_t, raw 11-bit disparity
  kImages,           ///< bot_core.images_t
  kImage,            ///< bot_core.image_t
  kImageArray,       ///< drake.lcmt_image_array, uint16
  kImageArrayFloat,  ///< drake.lcmt_image_array, float32
  kPointCloud2,      ///< bot_core.pointcloud2_t
  kPointCloud,       ///< drake.lcmt_point_cloud
};

/// Types that a pose can be sent as.
enum class PoseType {
  kPose,            ///< bot_core.pose_t
  kRigidTransform,  ///< bot_core.rigid_transform_t
  kPoseCov,         ///< pronto.rigid_body_pose_cov_t
};

/// What a type is called on the command line, and what it can.
struct ScanTypeInfo {
  ScanType type;
  const char* name;
  const char* carries;  ///< for the help
  bool knows_zlib;
  bool knows_png;
  bool brings_intrinsics;  ///< or needs none
};
const std::vector<ScanTypeInfo>& scan_types();
const ScanTypeInfo& info_of(ScanType type);

struct PoseTypeInfo {
  PoseType type;
  const char* name;
};
const std::vector<PoseTypeInfo>& pose_types();

/// What scans and poses are sent as.
struct WireFormat {
  ScanType scan = ScanType::kDepthScan;
  Encoding encoding = Encoding::kZlib;  ///< kRaw where the type knows no other
  PoseType pose = PoseType::kPose;
  double pose_sigma_m = 0.0;  ///< told with poses that can
  double pose_sigma_rad = 0.0;
};

/// The scan's message as LCM sends it. @pre the type knows the encoding
std::vector<std::uint8_t> encoded_scan(const DepthScan& scan, std::int32_t seq, const WireFormat& format);
/// The message of a pose. The body is the sensor: T_body_sensor is the identity.
std::vector<std::uint8_t> encoded_pose(const Eigen::Isometry3d& T_world_body, std::int64_t utime,
                                       const WireFormat& format);

/// What planemapd must be told of such scans beside the channel, as --set options; empty: nothing.
std::string settings_for(ScanType type, const PinholeIntrinsics& camera);

}  // namespace planemap::kinect_bridge

#include "formats/format.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "formats/field_formats.hpp"

namespace planemap::kinect_bridge {

const std::vector<ScanTypeInfo>& scan_types() {
  static const std::vector<ScanTypeInfo> types = {
      {ScanType::kDepthScan, "depth_scan", "planemap_lcm.depth_scan_t", true, false, true},
      {ScanType::kKinectFrame, "kinect_frame", "kinect.frame_msg_t, millimetres", true, false, false},
      {ScanType::kKinectDisparity, "kinect_disparity", "kinect.frame_msg_t, raw 11-bit disparity", true, false, false},
      {ScanType::kImages, "images", "bot_core.images_t", true, false, false},
      {ScanType::kImage, "image", "bot_core.image_t", false, false, false},
      {ScanType::kImageArray, "image_array", "drake.lcmt_image_array, uint16 millimetres", true, true, false},
      {ScanType::kImageArrayFloat, "image_array_float", "drake.lcmt_image_array, float32 metres", true, false, false},
      {ScanType::kPointCloud2, "pointcloud2", "bot_core.pointcloud2_t", false, false, true},
      {ScanType::kPointCloud, "point_cloud", "drake.lcmt_point_cloud", false, false, true},
  };
  return types;
}

const ScanTypeInfo& info_of(ScanType type) {
  const auto& types = scan_types();
  return *std::find_if(types.begin(), types.end(), [&](const ScanTypeInfo& info) { return info.type == type; });
}

const std::vector<PoseTypeInfo>& pose_types() {
  static const std::vector<PoseTypeInfo> types = {
      {PoseType::kPose, "pose"}, {PoseType::kRigidTransform, "rigid_transform"}, {PoseType::kPoseCov, "pose_cov"}};
  return types;
}

std::vector<std::uint8_t> encoded_scan(const DepthScan& scan, std::int32_t seq, const WireFormat& format) {
  switch (format.scan) {
    case ScanType::kDepthScan: {
      auto message = to_message(scan, format.encoding);
      message.seq = seq;
      return encode(message);
    }
    case ScanType::kKinectFrame:
      return encode(to_kinect_frame(scan, format.encoding));
    case ScanType::kKinectDisparity:
      return encode(to_kinect_disparity(scan, format.encoding));
    case ScanType::kImages:
      return encode(to_images(scan, format.encoding));
    case ScanType::kImage:
      return encode(to_image(scan));
    case ScanType::kImageArray:
    case ScanType::kImageArrayFloat: {
      const bool is_float = format.scan == ScanType::kImageArrayFloat;
      auto message = to_image_array(scan, is_float ? DrakePixels::kFloat32 : DrakePixels::kUint16, format.encoding);
      for (auto& image : message.images) image.header.seq = seq;
      return encode(message);
    }
    case ScanType::kPointCloud2: {
      auto message = to_pointcloud2(scan);
      message.seq = seq;
      return encode(message);
    }
    case ScanType::kPointCloud:
      return encode(to_point_cloud(scan));
  }
  return {};
}

std::vector<std::uint8_t> encoded_pose(const Eigen::Isometry3d& T_world_body, std::int64_t utime,
                                       const WireFormat& format) {
  switch (format.pose) {
    case PoseType::kPose:
      return encode(to_message(T_world_body, utime));
    case PoseType::kRigidTransform:
      return encode(to_rigid_transform(T_world_body, utime));
    case PoseType::kPoseCov:
      return encode(to_pose_cov(T_world_body, utime, format.pose_sigma_m, format.pose_sigma_rad));
  }
  return {};
}

std::string settings_for(ScanType type, const PinholeIntrinsics& camera) {
  if (info_of(type).brings_intrinsics) return {};
  std::string text =
      fmt::format("--set 'inputs.0.intrinsics=[{}, {}, {}, {}]'", camera.fx, camera.fy, camera.cx, camera.cy);
  if (type == ScanType::kImageArray || type == ScanType::kImageArrayFloat) {
    text += fmt::format(" --set 'inputs.0.frame={}'", kDepthFrame);
  }
  if (type == ScanType::kKinectDisparity) {
    text += fmt::format(" --set 'inputs.0.disparity=[{}, {}]'", kDisparityBaselineM, kDisparityOffset);
  }
  return text;
}

}  // namespace planemap::kinect_bridge

#include "wire.hpp"

#include <zlib.h>

#include "formats/pixels.hpp"

namespace planemap::kinect_bridge {
planemap_lcm::depth_scan_t to_message(const DepthScan& scan, Encoding encoding) {
  planemap_lcm::depth_scan_t message{};
  message.utime = scan.utime;
  message.width = scan.intrinsics.width;
  message.height = scan.intrinsics.height;
  message.fx = scan.intrinsics.fx;
  message.fy = scan.intrinsics.fy;
  message.cx = scan.intrinsics.cx;
  message.cy = scan.intrinsics.cy;
  message.depth_scale_m = scan.depth_scale_m;
  message.data = little_endian(scan.depth);
  message.encoding = planemap_lcm::depth_scan_t::ENCODING_RAW;
  if (encoding == Encoding::kZlib) {
    message.data = deflated(message.data);
    message.encoding = planemap_lcm::depth_scan_t::ENCODING_ZLIB;
  }
  message.size = static_cast<std::int32_t>(message.data.size());
  message.crc32 = static_cast<std::int32_t>(crc32(0, message.data.data(), static_cast<uInt>(message.data.size())));
  return message;
}

bot_core::pose_t to_message(const Eigen::Isometry3d& T_world_body, std::int64_t utime) {
  bot_core::pose_t message{};
  message.utime = utime;
  Eigen::Map<Eigen::Vector3d>(message.pos) = T_world_body.translation();
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(T_world_body.linear()).normalized();
  message.orientation[0] = rotation.w();
  message.orientation[1] = rotation.x();
  message.orientation[2] = rotation.y();
  message.orientation[3] = rotation.z();
  return message;
}

}  // namespace planemap::kinect_bridge

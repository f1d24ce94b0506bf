#pragma once

#include <Eigen/Geometry>
#include <bot_core/pose_t.hpp>
#include <cstdint>
#include <planemap/scan.hpp>
#include <planemap_lcm/depth_scan_t.hpp>
#include <vector>

namespace planemap::kinect_bridge {

enum class Encoding {
  kZlib,  ///< level 1: a sixth of the bytes
  kRaw,
  kPng,  ///< 16-bit grey; not of depth_scan_t
};

/// The message of a scan, raw or through zlib; its seq is for whoever sends it.
planemap_lcm::depth_scan_t to_message(const DepthScan& scan, Encoding encoding);

/// The message of a pose. The body is the sensor: T_body_sensor is the identity.
bot_core::pose_t to_message(const Eigen::Isometry3d& T_world_body, std::int64_t utime);

/// A message's bytes as LCM sends them.
template <class Message>
std::vector<std::uint8_t> encode(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace planemap::kinect_bridge

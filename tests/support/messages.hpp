#pragma once

#include <bot_core/pose_t.hpp>
#include <cstdint>
#include <functional>
#include <planemap_lcm/depth_scan_t.hpp>
#include <planemap_lcm/point_scan_t.hpp>
#include <planemap_lcm/request_t.hpp>
#include <pronto/rigid_body_pose_cov_t.hpp>
#include <vector>

namespace planemap {

using Bytes = std::vector<std::uint8_t>;

/// What a client's lcm-gen code would send.
template <class Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  if (message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) != static_cast<int>(bytes.size())) bytes.clear();
  return bytes;
}

/// A camera, its optical axis through the middle of the picture.
struct TestCamera {
  int width = 80;   ///< pixels
  int height = 60;  ///< pixels
  double focal_px = 75.0;
};

/// A depth_scan_t with a right checksum.
/// @param depth_mm  depth along z at pixel u, v
planemap_lcm::depth_scan_t depth_message(std::int64_t utime, std::int32_t seq, const TestCamera& camera,
                                         const std::function<std::uint16_t(int, int)>& depth_mm);
/// A small camera that looks straight at a wall.
planemap_lcm::depth_scan_t wall_message(std::int64_t utime, std::int32_t seq, std::uint16_t depth_mm = 1000);
/// The same pixels through zlib.
planemap_lcm::depth_scan_t zipped(planemap_lcm::depth_scan_t message);
/// Sets the checksum anew after a change of data.
void stamp_checksum(planemap_lcm::depth_scan_t& message);
void stamp_checksum(planemap_lcm::point_scan_t& message);

/// Three points, the last one not finite, with standard errors.
planemap_lcm::point_scan_t three_points_message(std::int64_t utime, std::int32_t seq);

/// A pose without rotation.
bot_core::pose_t pose_message(std::int64_t utime, double x_m = 0.0);
/// The same with a covariance: standard errors along and about all axes.
pronto::rigid_body_pose_cov_t pose_cov_message(std::int64_t utime, double x_m, double sigma_m, double sigma_rad);

planemap_lcm::request_t request_message(std::int16_t operation, std::int64_t request_id = 7, std::int32_t page = -1);

}  // namespace planemap

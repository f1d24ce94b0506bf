#pragma once

#include <bot_core/pose_t.hpp>
#include <cstdint>
#include <planemap_lcm/depth_scan_t.hpp>
#include <planemap_lcm/point_scan_t.hpp>
#include <planemap_lcm/request_t.hpp>
#include <vector>

namespace planemap::service {

using Bytes = std::vector<std::uint8_t>;

/// What a client's lcm-gen code would send.
template <class Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  if (message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) != static_cast<int>(bytes.size())) bytes.clear();
  return bytes;
}

/// A depth_scan_t of a small camera (80 x 60 pixels, f = 75 pixels) that looks straight at a wall, with a right
/// checksum.
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

planemap_lcm::request_t request_message(std::int16_t operation, std::int64_t request_id = 7, std::int32_t page = -1);

}  // namespace planemap::service

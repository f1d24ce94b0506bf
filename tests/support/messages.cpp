#include "support/messages.hpp"

#include <zlib.h>

#include <cstring>
#include <limits>

namespace planemap {

using planemap_lcm::depth_scan_t;
using planemap_lcm::point_scan_t;

depth_scan_t depth_message(std::int64_t utime, std::int32_t seq, const TestCamera& camera,
                           const std::function<std::uint16_t(int, int)>& depth_mm) {
  depth_scan_t message{};
  message.utime = utime;
  message.seq = seq;
  message.width = camera.width;
  message.height = camera.height;
  message.fx = message.fy = camera.focal_px;
  message.cx = camera.width / 2.0;
  message.cy = camera.height / 2.0;
  message.depth_scale_m = 0.001;
  message.encoding = depth_scan_t::ENCODING_RAW;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const std::uint16_t depth = depth_mm(u, v);
      message.data.push_back(static_cast<std::uint8_t>(depth & 0xffu));
      message.data.push_back(static_cast<std::uint8_t>(depth >> 8u));
    }
  }
  stamp_checksum(message);
  return message;
}

depth_scan_t wall_message(std::int64_t utime, std::int32_t seq, std::uint16_t depth_mm) {
  return depth_message(utime, seq, TestCamera{}, [depth_mm](int, int) { return depth_mm; });
}

depth_scan_t zipped(depth_scan_t message) {
  uLongf size = compressBound(message.data.size());
  std::vector<std::uint8_t> packed(size);
  compress2(packed.data(), &size, message.data.data(), message.data.size(), 1);
  packed.resize(size);
  message.data = std::move(packed);
  message.encoding = depth_scan_t::ENCODING_ZLIB;
  stamp_checksum(message);
  return message;
}

void stamp_checksum(depth_scan_t& message) {
  message.size = static_cast<std::int32_t>(message.data.size());
  message.crc32 = static_cast<std::int32_t>(crc32(0, message.data.data(), static_cast<uInt>(message.data.size())));
}

void stamp_checksum(point_scan_t& message) {
  message.n_values = static_cast<std::int32_t>(message.xyz_m.size());
  message.n_sigma = static_cast<std::int32_t>(message.sigma_m.size());
  uLong sum = 0;
  for (const auto* floats : {&message.xyz_m, &message.sigma_m}) {
    for (const float value : *floats) {
      std::uint32_t word = 0;
      std::memcpy(&word, &value, 4);
      const std::uint8_t bytes[] = {static_cast<std::uint8_t>(word >> 24), static_cast<std::uint8_t>(word >> 16),
                                    static_cast<std::uint8_t>(word >> 8), static_cast<std::uint8_t>(word)};
      sum = crc32(sum, bytes, 4);
    }
  }
  message.crc32 = static_cast<std::int32_t>(sum);
}

point_scan_t three_points_message(std::int64_t utime, std::int32_t seq) {
  point_scan_t message{};
  message.utime = utime;
  message.seq = seq;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  message.xyz_m = {0.5F, -0.25F, 2.0F, 1.0F, 0.0F, 3.0F, nan, 0.0F, 1.0F};
  message.sigma_m = {0.01F, 0.01F, 0.02F, 0.01F, 0.01F, 0.03F, 0.0F, 0.0F, 0.0F};
  stamp_checksum(message);
  return message;
}

bot_core::pose_t pose_message(std::int64_t utime, double x_m) {
  bot_core::pose_t message{};
  message.utime = utime;
  message.pos[0] = x_m;
  message.orientation[0] = 1.0;
  return message;
}

pronto::rigid_body_pose_cov_t pose_cov_message(std::int64_t utime, double x_m, double sigma_m, double sigma_rad) {
  pronto::rigid_body_pose_cov_t message{};
  message.utime = utime;
  message.quat[0] = 1.0;
  message.xyz_pos[0] = x_m;
  for (int i = 0; i < 6; ++i) {
    const double sigma = i < 3 ? sigma_rad : sigma_m;
    message.pose_cov[7 * i] = sigma * sigma;
    message.active_indices[i] = 1;
  }
  return message;
}

planemap_lcm::request_t request_message(std::int16_t operation, std::int64_t request_id, std::int32_t page) {
  planemap_lcm::request_t message{};
  message.utime = 1;
  message.request_id = request_id;
  message.reply_channel = "PLANEMAP_REPLY_TEST";
  message.operation = operation;
  message.page = page;
  return message;
}

}  // namespace planemap

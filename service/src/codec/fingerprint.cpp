#include "codec/fingerprint.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <bot_core/image_t.hpp>
#include <bot_core/images_t.hpp>
#include <bot_core/pointcloud2_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <drake/lcmt_image_array.hpp>
#include <drake/lcmt_point_cloud.hpp>
#include <kinect/frame_msg_t.hpp>
#include <planemap_lcm/depth_scan_t.hpp>
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/point_scan_t.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <planemap_lcm/request_t.hpp>
#include <planemap_lcm/status_t.hpp>
#include <pronto/rigid_body_pose_cov_t.hpp>
#include <vector>

#include "codec/wire_reader.hpp"

namespace planemap::service {
namespace {

template <class Message>
KnownType entry(const char* name, ScanFamily family, const char* belongs) {
  return {static_cast<std::uint64_t>(Message::getHash()), name, family, belongs};
}

template <class Message>
KnownType scan(const char* name, ScanFamily family) {
  return entry<Message>(name, family, "a scan, which belongs on inputs[].channel");
}
template <class Message>
KnownType pose(const char* name) {
  return entry<Message>(name, ScanFamily::kAuto, "a pose, which belongs on inputs[].pose_channel");
}
template <class Message>
KnownType own(const char* name) {
  return entry<Message>(name, ScanFamily::kAuto, "planemapd's own and neither a scan nor a pose");
}

const auto& known_types() {
  static const std::array types = {
      scan<planemap_lcm::depth_scan_t>("planemap_lcm.depth_scan_t", ScanFamily::kDepthScan),
      scan<planemap_lcm::point_scan_t>("planemap_lcm.point_scan_t", ScanFamily::kPointScan),
      scan<kinect::frame_msg_t>("kinect.frame_msg_t", ScanFamily::kKinectFrame),
      scan<bot_core::images_t>("bot_core.images_t", ScanFamily::kImages),
      scan<bot_core::image_t>("bot_core.image_t", ScanFamily::kImage),
      scan<drake::lcmt_image_array>("drake.lcmt_image_array", ScanFamily::kImageArray),
      scan<bot_core::pointcloud2_t>("bot_core.pointcloud2_t", ScanFamily::kPointCloud2),
      scan<drake::lcmt_point_cloud>("drake.lcmt_point_cloud", ScanFamily::kPointCloud),
      pose<bot_core::pose_t>("bot_core.pose_t"),
      pose<bot_core::rigid_transform_t>("bot_core.rigid_transform_t"),
      pose<pronto::rigid_body_pose_cov_t>("pronto.rigid_body_pose_cov_t"),
      own<planemap_lcm::request_t>("planemap_lcm.request_t"),
      own<planemap_lcm::reply_t>("planemap_lcm.reply_t"),
      own<planemap_lcm::status_t>("planemap_lcm.status_t"),
      own<planemap_lcm::planes_t>("planemap_lcm.planes_t"),
  };
  return types;
}

}  // namespace

std::uint64_t fingerprint_of(std::span<const std::uint8_t> message) {
  return static_cast<std::uint64_t>(WireReader(message).i64());
}

std::string fingerprint_text(std::uint64_t fingerprint) {
  return fmt::format("0x{:016x}", fingerprint);
}

const KnownType* known_type(std::uint64_t fingerprint) {
  const auto& types = known_types();
  const auto found =
      std::find_if(types.begin(), types.end(), [&](const KnownType& type) { return type.fingerprint == fingerprint; });
  return found == types.end() ? nullptr : &*found;
}

const KnownType& type_of(ScanFamily family) {
  const auto& types = known_types();
  return *std::find_if(types.begin(), types.end(), [&](const KnownType& type) { return type.family == family; });
}

std::string scan_types_text() {
  std::vector<std::string> texts;
  texts.reserve(known_types().size());
  for (const KnownType& type : known_types()) {
    if (type.family == ScanFamily::kAuto) continue;
    texts.push_back(fmt::format("{} ({})", type.name, fingerprint_text(type.fingerprint)));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace planemap::service

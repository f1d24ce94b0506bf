// The formats that are point clouds.
#include <bit>
#include <limits>

#include "formats/field_formats.hpp"
#include "formats/pixels.hpp"

namespace planemap::kinect_bridge {
namespace {

constexpr std::int8_t kFloat32 = 7;
constexpr int kPointBytes = 12;

/// Calls put(x, y, z) for each pixel, NaN where nothing was seen.
template <class Put>
void for_each_point(const DepthScan& scan, const Put& put) {
  const auto& camera = scan.intrinsics;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::uint16_t* depth = scan.depth.data();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u, ++depth) {
      if (*depth == kNoReturn || *depth == kNoReturnHigh) {
        put(kNan, kNan, kNan);
        continue;
      }
      const double z_m = *depth * scan.depth_scale_m;
      put(static_cast<float>((u - camera.cx) / camera.fx * z_m), static_cast<float>((v - camera.cy) / camera.fy * z_m),
          static_cast<float>(z_m));
    }
  }
}

void append(std::vector<std::uint8_t>& bytes, float value) {
  append_little_endian(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace

bot_core::pointcloud2_t to_pointcloud2(const DepthScan& scan) {
  bot_core::pointcloud2_t cloud{};
  cloud.utime = scan.utime;
  cloud.frame_id = "kinect";
  cloud.width = scan.intrinsics.width;
  cloud.height = scan.intrinsics.height;
  for (const char* name : {"x", "y", "z"}) {
    bot_core::pointfield_t field{};
    field.name = name;
    field.offset = 4 * cloud.nfields++;
    field.datatype = kFloat32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.point_step = kPointBytes;
  cloud.row_step = kPointBytes * cloud.width;
  cloud.data.reserve(kPointBytes * scan.depth.size());
  for_each_point(scan, [&](float x, float y, float z) {
    for (const float value : {x, y, z}) append(cloud.data, value);
  });
  cloud.data_nbytes = static_cast<std::int32_t>(cloud.data.size());
  return cloud;
}

drake::lcmt_point_cloud to_point_cloud(const DepthScan& scan) {
  drake::lcmt_point_cloud cloud{};
  cloud.utime = scan.utime;
  cloud.frame_name = "kinect";
  cloud.height = 1;
  for (const char* name : {"x", "y", "z"}) {
    drake::lcmt_point_cloud_field field{};
    field.name = name;
    field.byte_offset = 4 * cloud.num_fields++;
    field.datatype = kFloat32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.flags = drake::lcmt_point_cloud::IS_STRICTLY_FINITE;
  cloud.point_step = kPointBytes;
  cloud.data.reserve(kPointBytes * scan.depth.size());
  for_each_point(scan, [&](float x, float y, float z) {
    if (!(z > 0.0F)) return;
    for (const float value : {x, y, z}) append(cloud.data, value);
    ++cloud.width;
  });
  cloud.row_step = kPointBytes * cloud.width;
  cloud.data_size = static_cast<std::int64_t>(cloud.data.size());
  return cloud;
}

}  // namespace planemap::kinect_bridge

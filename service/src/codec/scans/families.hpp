#pragma once

#include <cstddef>

#include "codec/scan_codec.hpp"
#include "codec/wire_reader.hpp"

namespace planemap::service {

// One decoder a family; each reads behind the fingerprint, checks every number before memory is taken for it and names
// the type in its errors. max_bytes: greatest image or cloud after decompression.

/// Checks that the reader stands at the end of a whole message.
Decoded<void> check_end(const WireReader& reader, const char* type);

/// planemap_lcm.depth_scan_t. @param message_bytes  of the whole message, for its errors
Decoded<DecodedScan> decode_depth_scan(WireReader reader, std::size_t message_bytes, std::size_t max_bytes);
/// planemap_lcm.point_scan_t
Decoded<DecodedScan> decode_point_scan(WireReader reader, std::size_t max_bytes);
/// kinect.frame_msg_t: millimetres or raw disparity, which format.disparity makes depth
Decoded<DecodedScan> decode_kinect_frame(WireReader reader, const ScanFormat& format, std::size_t max_bytes);
/// bot_core.images_t: its first image that is DEPTH_MM or DEPTH_MM_ZIPPED
Decoded<DecodedScan> decode_images(WireReader reader, const ScanFormat& format, std::size_t max_bytes);
/// bot_core.image_t: 16-bit grey, in units of format.depth_unit_m
Decoded<DecodedScan> decode_image(WireReader reader, const ScanFormat& format, std::size_t max_bytes);
/// drake.lcmt_image_array: its only depth image, or the one of format.frame
Decoded<DecodedScan> decode_image_array(WireReader reader, const ScanFormat& format, std::size_t max_bytes);
/// bot_core.pointcloud2_t: x, y and z in the sensor's frame
Decoded<DecodedScan> decode_point_cloud2(WireReader reader, const ScanFormat& format, std::size_t max_bytes);
/// drake.lcmt_point_cloud: the same
Decoded<DecodedScan> decode_point_cloud(WireReader reader, const ScanFormat& format, std::size_t max_bytes);

}  // namespace planemap::service

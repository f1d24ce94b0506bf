#pragma once

#include <cstddef>
#include <optional>
#include <planemap/scan.hpp>
#include <string>

namespace planemap::service {

/// The types that scans come in; a fingerprint names one.
enum class ScanFamily {
  kAuto,         ///< whichever comes
  kDepthScan,    ///< planemap_lcm.depth_scan_t
  kPointScan,    ///< planemap_lcm.point_scan_t
  kKinectFrame,  ///< kinect.frame_msg_t
  kImages,       ///< bot_core.images_t; openni2 and multisense declare the same
  kImage,        ///< bot_core.image_t
  kImageArray,   ///< drake.lcmt_image_array; robotlocomotion declares the same
  kPointCloud2,  ///< bot_core.pointcloud2_t
  kPointCloud,   ///< drake.lcmt_point_cloud
};

/// How a raw disparity d of a Kinect becomes depth: z = 8 * fx * baseline_m / (offset - d).
struct DisparityCalibration {
  double baseline_m = 0.0;  ///< between projector and infrared camera
  double offset = 0.0;      ///< disparity of what is infinitely far away
};

/// What a scan's message does not say itself.
struct ScanFormat {
  ScanFamily family = ScanFamily::kAuto;
  std::string frame;                            ///< the only one that is taken, where messages name one; empty: any
  std::optional<PinholeIntrinsics> intrinsics;  ///< width and height 0: of images of any size
  double depth_unit_m = 0.001;                  ///< of image_t; floats and disparities are rounded to it
  std::optional<DisparityCalibration> disparity;
};

}  // namespace planemap::service

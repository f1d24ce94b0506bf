#pragma once

#include <initializer_list>
#include <planemap/config.hpp>
#include <string>
#include <vector>

#include "codec/scan_format.hpp"

namespace planemap::service {

/// LCM carries no longer channel names.
constexpr double kMaxChannelChars = 63;

/// A box fixed to the body, metres in the body frame; points inside are the robot's own.
struct MaskBox {
  std::vector<double> min_m;  ///< x y z
  std::vector<double> max_m;  ///< x y z
};

template <MaybeConst<MaskBox> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"min_m", "least corner in the body frame, x y z", 3, 3}, c.min_m);
  visit(FieldInfo{"max_m", "greatest corner in the body frame, x y z", 3, 3}, c.max_m);
}

/// The words for families.
inline std::initializer_list<Choice<ScanFamily>> scan_family_choices() {
  static const std::initializer_list<Choice<ScanFamily>> choices = {
      {"auto", ScanFamily::kAuto},
      {"depth_scan", ScanFamily::kDepthScan},
      {"point_scan", ScanFamily::kPointScan},
      {"kinect_frame", ScanFamily::kKinectFrame},
      {"images", ScanFamily::kImages},
      {"image", ScanFamily::kImage},
      {"image_array", ScanFamily::kImageArray},
      {"pointcloud2", ScanFamily::kPointCloud2},
      {"point_cloud", ScanFamily::kPointCloud},
  };
  return choices;
}

/// One sensor.
struct InputConfig {
  std::string name = "kinect";
  std::string channel = "PLANEMAP_SCAN";
  ScanFamily family = ScanFamily::kAuto;  ///< the only type that is taken on the channel
  std::string frame;                      ///< of the image or cloud, where messages name one; empty: any
  std::vector<double> intrinsics;         ///< fx fy cx cy, or with width and height; empty: none
  double depth_unit_m = 0.001;            ///< for types that don't say it
  std::vector<double> disparity;          ///< baseline in metres and offset; empty: none
  std::string pose_channel = "POSE";
  std::vector<double> translation_m = {0.0, 0.0, 0.0};       ///< T_body_sensor: origin of the sensor in the body frame
  std::vector<double> rotation_wxyz = {1.0, 0.0, 0.0, 0.0};  ///< T_body_sensor: unit quaternion, sensor to body
  double min_range_m = 0.0;                                  ///< depth; beside those of the section sensor
  double max_range_m = 1000.0;
  double max_rate_hz = 0.0;  ///< scans beyond this rate are dropped and counted; 0: no limit
  std::vector<MaskBox> body_mask;
};

template <MaybeConst<InputConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"name", "of the sensor, for logs and counters", 1, 64}, c.name);
  visit(FieldInfo{"channel", "of its scans; docs/lcm.md lists the types that it may carry", 1, kMaxChannelChars},
        c.channel);
  visit(FieldInfo{"family", "the only type that is taken there; auto: whichever comes, told by its fingerprint"},
        c.family, scan_family_choices());
  visit(FieldInfo{"frame", "which image of lcmt_image_array is meant, or the frame that clouds must be of; empty: any",
                  0, 255},
        c.frame);
  visit(FieldInfo{"intrinsics",
                  "fx, fy, cx, cy of the depth image, pixels, for types that bring none; then its width and height, to "
                  "be checked",
                  0, 6},
        c.intrinsics);
  visit(FieldInfo{"depth_unit_m", "depths of image_t are in this unit; float and disparity depths are rounded to it",
                  1e-6, 0.1},
        c.depth_unit_m);
  visit(FieldInfo{"disparity", "baseline b in metres and offset o of a Kinect's raw disparity d: z = 8 fx b / (o - d)",
                  0, 2},
        c.disparity);
  visit(FieldInfo{"pose_channel",
                  "of the body's poses: bot_core.pose_t, rigid_transform_t or pronto.rigid_body_pose_cov_t", 1,
                  kMaxChannelChars},
        c.pose_channel);
  visit(FieldInfo{"translation_m", "where the sensor is in the body frame, x y z", 3, 3}, c.translation_m);
  visit(FieldInfo{"rotation_wxyz",
                  "unit quaternion, takes the sensor's axes (x right, y down, z forward) to the body's", 4, 4},
        c.rotation_wxyz);
  visit(FieldInfo{"min_range_m", "nearer depths are left out, beside sensor.min_range_m", 0.0, 1000.0}, c.min_range_m);
  visit(FieldInfo{"max_range_m", "farther depths are left out, beside sensor.max_range_m", 0.0, 1000.0}, c.max_range_m);
  visit(FieldInfo{"max_rate_hz", "scans beyond this rate are dropped and counted; 0: no limit", 0.0, 10000.0},
        c.max_rate_hz);
  visit(FieldInfo{"body_mask", "boxes of the body frame whose points are the robot's own", 0, 64}, c.body_mask);
}

}  // namespace planemap::service

#include "codec/fingerprint.hpp"

#include <gtest/gtest.h>

#include <bot_core/image_t.hpp>
#include <bot_core/images_t.hpp>
#include <bot_core/pointcloud2_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <drake/lcmt_image.hpp>
#include <drake/lcmt_image_array.hpp>
#include <drake/lcmt_point_cloud.hpp>
#include <kinect/depth_msg_t.hpp>
#include <kinect/frame_msg_t.hpp>
#include <kinect/image_msg_t.hpp>
#include <pronto/rigid_body_pose_cov_t.hpp>

#include "codec/pose_codec.hpp"
#include "codec/scan_codec.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

template <class Message>
std::uint64_t hash() {
  return static_cast<std::uint64_t>(Message::getHash());
}

// As the messages of the field have them; not computed from our own declarations.
TEST(Fingerprint, ReDeclaredTypesAreThoseOfTheField) {
  EXPECT_EQ(hash<kinect::frame_msg_t>(), 0xac3dd2c457d02257U);
  EXPECT_EQ(hash<kinect::depth_msg_t>(), 0x400db1119c176becU);
  EXPECT_EQ(hash<kinect::image_msg_t>(), 0x03f81d11fd4126c6U);
  EXPECT_EQ(hash<bot_core::images_t>(), 0x20ba4f05e8f5e33aU);
  EXPECT_EQ(hash<bot_core::image_t>(), 0x14739ffe13d5f5f0U);
  EXPECT_EQ(hash<drake::lcmt_image_array>(), 0x1572a7d08d9022e6U);
  EXPECT_EQ(hash<drake::lcmt_image>(), 0xbd7080d565ec47d1U);
  EXPECT_EQ(hash<bot_core::pointcloud2_t>(), 0x0bcd5ce4bf5a1b4aU);
  EXPECT_EQ(hash<drake::lcmt_point_cloud>(), 0x17f2c128b5d25a95U);
  EXPECT_EQ(hash<bot_core::pose_t>(), 0x2e16efb052b0105eU);
  EXPECT_EQ(hash<bot_core::rigid_transform_t>(), 0xea9ffbf2acc5c5aeU);
  EXPECT_EQ(hash<pronto::rigid_body_pose_cov_t>(), 0x2b9733583b090550U);
}

TEST(Fingerprint, EveryFamilyHasAType) {
  int families = 0;
  for (int i = static_cast<int>(ScanFamily::kDepthScan); i <= static_cast<int>(ScanFamily::kPointCloud); ++i) {
    const KnownType& type = type_of(static_cast<ScanFamily>(i));
    EXPECT_EQ(type.family, static_cast<ScanFamily>(i));
    EXPECT_EQ(known_type(type.fingerprint), &type);
    ++families;
  }
  EXPECT_EQ(families, 8);
  EXPECT_STREQ(known_type(hash<bot_core::pose_t>())->name, "bot_core.pose_t");
  EXPECT_EQ(known_type(1), nullptr);
}

TEST(Fingerprint, AConfiguredFamilyTakesNoOther) {
  ScanFormat format;
  format.family = ScanFamily::kKinectFrame;
  const auto scan = decode_scan(encoded(wall_message(5, 1)), 1 << 20, format);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().reason, "wrong_channel");
  EXPECT_NE(scan.error().message.find("planemap_lcm.depth_scan_t (0x"), std::string::npos);
  EXPECT_NE(scan.error().message.find(") is a scan of another family than inputs[].family says: kinect.frame_msg_t "
                                      "(0xac3dd2c457d02257)"),
            std::string::npos)
      << scan.error().message;
}

TEST(Fingerprint, OurOwnOutputIsToldWhereItIsHeard) {
  planemap_lcm::request_t request = request_message(1);
  const auto scan = decode_scan(encoded(request), 1 << 20);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().reason, "wrong_channel");
  EXPECT_NE(scan.error().message.find("is planemapd's own and neither a scan nor a pose"), std::string::npos);
  const auto pose = decode_pose(encoded(request));
  ASSERT_FALSE(pose);
  EXPECT_EQ(pose.error().reason, "wrong_channel");
}

}  // namespace
}  // namespace planemap::service

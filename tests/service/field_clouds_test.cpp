// Point clouds of other stacks, and their other poses.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "codec/pose_codec.hpp"
#include "codec/scan_codec.hpp"
#include "formats/field_formats.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kMaxBytes = 1 << 20;
constexpr std::int64_t kUtime = 1'700'000'000'000'000;

/// 4 x 3 pixels, the first of which sees nothing.
DepthScan test_scan() {
  DepthScan scan;
  scan.utime = kUtime;
  scan.intrinsics = {4, 3, 2.0, 2.0, 1.5, 1.0};
  for (int i = 0; i < 12; ++i) scan.depth.push_back(static_cast<std::uint16_t>(i == 0 ? 0 : 1000 + i));
  return scan;
}

template <class Message>
void expect_rejected(const Message& message, const std::string& reason, const std::string& text,
                     const ScanFormat& format = {}, std::size_t max_bytes = kMaxBytes) {
  const auto scan = decode_scan(encoded(message), max_bytes, format);
  ASSERT_FALSE(scan) << text;
  EXPECT_EQ(scan.error().reason, reason) << scan.error().message;
  EXPECT_NE(scan.error().message.find(text), std::string::npos) << scan.error().message;
}

TEST(FieldClouds, PointsOfBothFamiliesAreThoseOfThePixels) {
  auto first = kinect_bridge::to_pointcloud2(test_scan());
  first.seq = 41;
  const auto all = decode_scan(encoded(first), kMaxBytes);
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ(all->seq, 41);
  const auto& xyz = std::get<PointScan>(all->scan).xyz_m;
  ASSERT_EQ(xyz.size(), 36u);
  EXPECT_TRUE(std::isnan(xyz[0]) && std::isnan(xyz[2]));
  EXPECT_FLOAT_EQ(xyz[3], -0.25F * 1.001F);  // (1 - 1.5) / 2
  EXPECT_FLOAT_EQ(xyz[4], -0.5F * 1.001F);
  EXPECT_FLOAT_EQ(xyz[5], 1.001F);
  const auto finite = decode_scan(encoded(kinect_bridge::to_point_cloud(test_scan())), kMaxBytes);
  ASSERT_TRUE(finite) << finite.error().message;
  EXPECT_EQ(std::get<PointScan>(finite->scan).utime, kUtime);
  EXPECT_EQ(finite->seq, -1);
  EXPECT_EQ(std::get<PointScan>(finite->scan).xyz_m, std::vector<float>(xyz.begin() + 3, xyz.end()));
}

/// 2 x 2 points of big-endian doubles behind a colour, 40 bytes a point, 100 bytes a row.
bot_core::pointcloud2_t awkward_cloud() {
  bot_core::pointcloud2_t cloud{};
  cloud.utime = kUtime;
  cloud.frame_id = "camera";
  cloud.width = cloud.height = 2;
  cloud.is_bigendian = 1;
  cloud.point_step = 40;
  cloud.row_step = 100;
  const std::pair<const char*, int> fields[] = {{"rgb", 0}, {"z", 8}, {"y", 16}, {"x", 24}};
  for (const auto& [name, offset] : fields) {
    bot_core::pointfield_t field{};
    field.name = name;
    field.offset = offset;
    field.datatype = std::string(name) == "rgb" ? 7 : 8;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.nfields = 4;
  cloud.data.resize(200, 0xEE);
  const double values[] = {3.5, 2.5, 1.5};  // z, y, x
  for (std::size_t point = 0; point < 4; ++point) {
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint64_t word = 0;
      const double value = values[i] + static_cast<double>(point);
      std::memcpy(&word, &value, 8);
      word = __builtin_bswap64(word);
      std::memcpy(&cloud.data[point / 2 * 100 + point % 2 * 40 + 8 + 8 * i], &word, 8);
    }
  }
  cloud.data_nbytes = 200;
  return cloud;
}

TEST(FieldClouds, FieldsMayStandAnywhere) {
  auto cloud = awkward_cloud();
  const std::vector<float> expected = {1.5F, 2.5F, 3.5F, 2.5F, 3.5F, 4.5F, 3.5F, 4.5F, 5.5F, 4.5F, 5.5F, 6.5F};
  auto scan = decode_scan(encoded(cloud), kMaxBytes);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(std::get<PointScan>(scan->scan).xyz_m, expected);
  cloud.data.resize(180);  // some leave the last row's padding out
  cloud.data_nbytes = 180;
  scan = decode_scan(encoded(cloud), kMaxBytes);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(std::get<PointScan>(scan->scan).xyz_m, expected);
}

TEST(FieldClouds, DoublesBeyondFloatsAreNoPoints) {
  auto cloud = awkward_cloud();
  const std::uint8_t huge[] = {0x7f, 0xe0, 0, 0, 0, 0, 0, 0};  // 9e307
  std::copy(std::begin(huge), std::end(huge), cloud.data.begin() + 8);
  const auto scan = decode_scan(encoded(cloud), kMaxBytes);
  ASSERT_TRUE(scan);
  EXPECT_TRUE(std::isnan(std::get<PointScan>(scan->scan).xyz_m[2]));
}

TEST(FieldClouds, CloudsThatCannotBeUsed) {
  struct Case {
    const char* reason;
    const char* text;
    std::function<void(bot_core::pointcloud2_t&)> spoil;
  };
  const Case cases[] = {
      {"time", "pointcloud2_t: utime is -3, must be > 0", [](auto& m) { m.utime = -3; }},
      {"size", "-2 x 2 points, point_step 40, row_step 100 (allowed", [](auto& m) { m.width = -2; }},
      {"size", "2 x 2 points, point_step 0", [](auto& m) { m.point_step = 0; }},
      {"size", "row_step -1", [](auto& m) { m.row_step = -1; }},
      {"too_large", "2147483647 x 2147483647 points are", [](auto& m) { m.width = m.height = 0x7fffffff; }},
      {"size", "row_step is 79 for 2 points of 40 bytes", [](auto& m) { m.row_step = 79; }},
      {"size", "200 bytes of data for 3 x 2 points of 40 bytes and rows of 120, must be 240",
       [](auto& m) {
         m.width = 3;
         m.row_step = 120;
       }},
      {"size", "200 bytes of data for 2 x 1 points of 40 bytes and rows of 100, must be 100",
       [](auto& m) { m.height = 1; }},
      {"format", "needs one field named x", [](auto& m) { m.fields[3].name = "X"; }},
      {"format", "needs one field named z",
       [](auto& m) {
         m.fields[3].name = "z";
         m.fields[0].name = "x";
       }},
      {"format", "field y has datatype 4 and count 1 (allowed: 7 float32 or 8 float64, and 1)",
       [](auto& m) { m.fields[2].datatype = 4; }},
      {"format", "field y has datatype 8 and count 3", [](auto& m) { m.fields[2].count = 3; }},
      {"size", "field x at byte 33 is not within point_step, 40 bytes", [](auto& m) { m.fields[3].offset = 33; }},
      {"size", "field x at byte -8 is not within", [](auto& m) { m.fields[3].offset = -8; }},
      {"size", "field x at byte 2147483647 is not within", [](auto& m) { m.fields[3].offset = 0x7fffffff; }},
  };
  for (const Case& c : cases) {
    auto message = awkward_cloud();
    c.spoil(message);
    expect_rejected(message, c.reason, c.text);
  }
  expect_rejected(awkward_cloud(), "too_large", "2 x 2 points are 48 bytes, limits.image_bytes is 47", {}, 47);
  ScanFormat format;
  format.frame = "lidar";
  expect_rejected(awkward_cloud(), "frame", "the cloud is of frame 'camera', inputs[].frame is 'lidar'", format);
}

TEST(FieldClouds, DrakesCountsAreChecked) {
  struct Case {
    const char* reason;
    const char* text;
    std::function<void(drake::lcmt_point_cloud&)> spoil;
  };
  const Case cases[] = {
      {"size", "lcmt_point_cloud: 4611686018427387904 x 4 points",
       [](auto& m) {
         m.width = std::int64_t{1} << 62;
         m.height = 4;
       }},
      {"size", "row_step 9223372036854775807", [](auto& m) { m.row_step = 0x7fffffffffffffff; }},
      {"size", "132 bytes of data for 12 x 1 points of 12 bytes", [](auto& m) { m.width = 12; }},
  };
  for (const Case& c : cases) {
    auto message = kinect_bridge::to_point_cloud(test_scan());
    c.spoil(message);
    expect_rejected(message, c.reason, c.text);
  }
  const Bytes good = encoded(kinect_bridge::to_point_cloud(test_scan()));
  const std::size_t size_at = good.size() - 132 - 8;
  Bytes bytes = good;
  bytes[size_at + 7] ^= 1;
  auto scan = decode_scan(bytes, kMaxBytes);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().message, "lcmt_point_cloud: data_size is 133, but 132 bytes follow");
  bytes = good;
  bytes[size_at] = 0x80;
  scan = decode_scan(bytes, kMaxBytes);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().reason, "size");
  bytes = good;
  bytes[size_at - 2] = 0x80;  // filler_size
  scan = decode_scan(bytes, kMaxBytes);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().message, "lcmt_point_cloud: filler_size is -32768");
}

TEST(FieldClouds, FillerAndAnEmptyCloudAreGood) {
  auto cloud = kinect_bridge::to_point_cloud(test_scan());
  cloud.filler = {1, 2, 3};
  cloud.filler_size = 3;
  EXPECT_TRUE(decode_scan(encoded(cloud), kMaxBytes));
  cloud.data.clear();
  cloud.data_size = cloud.width = cloud.row_step = 0;
  const auto scan = decode_scan(encoded(cloud), kMaxBytes);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_TRUE(std::get<PointScan>(scan->scan).xyz_m.empty());
}

TEST(FieldPoses, RigidTransformIsThePoseOfTheBody) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(1.0, -2.0, 3.0);
  T.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0).toRotationMatrix();
  const auto message = kinect_bridge::to_rigid_transform(T, kUtime);
  const auto pose = decode_pose(encoded(message));
  ASSERT_TRUE(pose) << pose.error().message;
  EXPECT_EQ(pose->utime, kUtime);
  EXPECT_EQ(pose->p_world_m, T.translation());
  EXPECT_NEAR((pose->q_world_body.toRotationMatrix() - T.linear()).norm(), 0.0, 1e-12);
  EXPECT_FALSE(pose->covariance);
}

TEST(FieldPoses, RigidTransformsThatCannotBeUsed) {
  struct Case {
    const char* reason;
    const char* text;
    std::function<void(bot_core::rigid_transform_t&)> spoil;
  };
  const Case cases[] = {
      {"time", "rigid_transform_t: utime is 0, must be > 0", [](auto& m) { m.utime = 0; }},
      {"not_finite", "rigid_transform_t: position nan 0 0 (allowed: finite", [](auto& m) { m.trans[0] = NAN; }},
      {"quaternion", "rigid_transform_t: orientation 0 0 0 0 has length 0, must be 1", [](auto& m) { m.quat[0] = 0; }},
  };
  for (const Case& c : cases) {
    auto message = kinect_bridge::to_rigid_transform(Eigen::Isometry3d::Identity(), kUtime);
    c.spoil(message);
    const auto pose = decode_pose(encoded(message));
    ASSERT_FALSE(pose) << c.text;
    EXPECT_EQ(pose.error().reason, c.reason);
    EXPECT_NE(pose.error().message.find(c.text), std::string::npos) << pose.error().message;
  }
  auto bytes = encoded(kinect_bridge::to_rigid_transform(Eigen::Isometry3d::Identity(), kUtime));
  bytes.push_back(0);
  EXPECT_EQ(decode_pose(bytes).error().message, "rigid_transform_t: 73 bytes, must be 72");
}

TEST(FieldPoses, StandardErrorsComeThrough) {
  const auto message = kinect_bridge::to_pose_cov(Eigen::Isometry3d::Identity(), kUtime, 0.02, 0.001);
  const auto pose = decode_pose(encoded(message));
  ASSERT_TRUE(pose) << pose.error().message;
  ASSERT_TRUE(pose->covariance);
  EXPECT_NEAR((*pose->covariance)(0, 0), 4e-4, 1e-12);
  EXPECT_NEAR((*pose->covariance)(5, 5), 1e-6, 1e-12);
}

}  // namespace
}  // namespace planemap::service

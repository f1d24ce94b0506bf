#include "codec/scan_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "codec/pose_codec.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::depth_scan_t;
using planemap_lcm::point_scan_t;

constexpr std::size_t kMaxBytes = 64 << 20;

std::string reason_of(const Bytes& message, std::size_t max_bytes = kMaxBytes) {
  const auto scan = decode_scan(message, max_bytes);
  return scan ? "accepted" : scan.error().reason;
}

TEST(ScanCodec, FingerprintsAreThoseOfTheTypes) {
  EXPECT_EQ(fingerprint_of(encoded(bot_core::pose_t{})), 0x2e16efb052b0105eU);
  EXPECT_EQ(fingerprint_text(0x2e16efb052b0105eU), "0x2e16efb052b0105e");
  EXPECT_EQ(fingerprint_of(Bytes{1, 2, 3}), 0U);
}

TEST(ScanCodec, RawDepthComesBack) {
  auto message = wall_message(1234567, 42);
  message.data[0] = 0x34;
  message.data[1] = 0x12;
  stamp_checksum(message);
  const auto decoded = decode_scan(encoded(message), kMaxBytes);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->seq, 42);
  const auto& scan = std::get<DepthScan>(decoded->scan);
  EXPECT_EQ(scan.utime, 1234567);
  EXPECT_EQ(scan.intrinsics, (PinholeIntrinsics{80, 60, 75.0, 75.0, 40.0, 30.0}));
  EXPECT_EQ(scan.depth_scale_m, 0.001);
  ASSERT_EQ(scan.depth.size(), 4800u);
  EXPECT_EQ(scan.depth[0], 0x1234);
  EXPECT_EQ(scan.depth[4799], 1000);
}

TEST(ScanCodec, ZippedDepthIsTheSameAsRaw) {
  const auto raw = decode_scan(encoded(wall_message(5, 1)), kMaxBytes);
  const auto packed = decode_scan(encoded(zipped(wall_message(5, 1))), kMaxBytes);
  ASSERT_TRUE(raw);
  ASSERT_TRUE(packed) << packed.error().message;
  EXPECT_EQ(std::get<DepthScan>(raw->scan).depth, std::get<DepthScan>(packed->scan).depth);
}

TEST(ScanCodec, PointsComeBackBitByBit) {
  const auto message = three_points_message(99, 3);
  const auto decoded = decode_scan(encoded(message), kMaxBytes);
  ASSERT_TRUE(decoded) << decoded.error().message;
  const auto& scan = std::get<PointScan>(decoded->scan);
  EXPECT_EQ(scan.utime, 99);
  ASSERT_EQ(scan.xyz_m.size(), 9u);
  EXPECT_EQ(std::memcmp(scan.xyz_m.data(), message.xyz_m.data(), 36), 0);
  EXPECT_EQ(scan.sigma_m, message.sigma_m);
}

TEST(ScanCodec, PointsWithoutErrorsAndWithoutPointsAreGood) {
  auto message = three_points_message(99, 3);
  message.sigma_m.clear();
  stamp_checksum(message);
  EXPECT_EQ(reason_of(encoded(message)), "accepted");
  message.xyz_m.clear();
  stamp_checksum(message);
  EXPECT_EQ(reason_of(encoded(message)), "accepted");
}

TEST(ScanCodec, RejectsBadDepthHeadersByReason) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  struct Case {
    const char* reason;
    std::function<void(depth_scan_t&)> spoil;
  };
  const Case cases[] = {
      {"time", [](auto& m) { m.utime = 0; }},
      {"time", [](auto& m) { m.utime = -5; }},
      {"size", [](auto& m) { m.width = 0; }},
      {"size", [](auto& m) { m.width = -80; }},
      {"size", [](auto& m) { m.height = 4097; }},
      {"size", [](auto& m) { m.width = m.height = 0x7fffffff; }},
      {"size", [](auto& m) { m.width = 81; }},
      {"intrinsics", [&](auto& m) { m.fx = nan; }},
      {"intrinsics", [&](auto& m) { m.fy = 0.0; }},
      {"intrinsics", [&](auto& m) { m.fx = -75.0; }},
      {"intrinsics", [&](auto& m) { m.cx = infinity; }},
      {"intrinsics", [&](auto& m) { m.fx = 1e-300; }},
      {"intrinsics", [&](auto& m) { m.cy = 1e9; }},
      {"intrinsics", [&](auto& m) { m.depth_scale_m = 0.0; }},
      {"intrinsics", [&](auto& m) { m.depth_scale_m = nan; }},
      {"encoding", [](auto& m) { m.encoding = 2; }},
      {"checksum", [](auto& m) { m.crc32 ^= 1; }},
      {"checksum", [](auto& m) { m.data[100] ^= 1; }},
  };
  for (const auto& c : cases) {
    auto message = wall_message(5, 1);
    c.spoil(message);
    EXPECT_EQ(reason_of(encoded(message)), c.reason) << &c - cases;
  }
}

TEST(ScanCodec, ErrorsSayWhatWithNumbers) {
  auto message = wall_message(5, 1);
  message.width = 81;
  EXPECT_EQ(decode_scan(encoded(message), kMaxBytes).error().message,
            "depth_scan_t: 9600 bytes of raw data for 81 x 60 pixels, must be 9720");
  EXPECT_EQ(decode_scan(encoded(wall_message(5, 1)), 9599).error().message,
            "depth_scan_t: 80 x 60 pixels are 9600 bytes, limits.image_bytes is 9599");
  EXPECT_EQ(reason_of(encoded(wall_message(5, 1)), 9600), "accepted");
}

TEST(ScanCodec, ZlibMustGiveExactlyThePixels) {
  auto shorter = wall_message(5, 1);
  shorter.data.resize(9598);
  auto message = zipped(shorter);
  EXPECT_EQ(reason_of(encoded(message)), "encoding");
  auto longer = wall_message(5, 1);
  longer.data.resize(9602);
  EXPECT_EQ(reason_of(encoded(zipped(longer))), "encoding");
  message = zipped(wall_message(5, 1));
  message.data.push_back(0);  // behind the end of the stream
  stamp_checksum(message);
  EXPECT_EQ(reason_of(encoded(message)), "encoding");
  message = zipped(wall_message(5, 1));
  message.data.resize(message.data.size() / 2);
  stamp_checksum(message);
  EXPECT_EQ(reason_of(encoded(message)), "encoding");
  message.data.clear();
  stamp_checksum(message);
  EXPECT_EQ(reason_of(encoded(message)), "size");
}

TEST(ScanCodec, RejectsBadPointCounts) {
  auto message = three_points_message(5, 1);
  message.xyz_m.pop_back();
  stamp_checksum(message);
  EXPECT_EQ(reason_of(encoded(message)), "size");
  message = three_points_message(5, 1);
  message.sigma_m.resize(6);
  stamp_checksum(message);
  EXPECT_EQ(reason_of(encoded(message)), "size");
  message = three_points_message(5, 1);
  message.crc32 += 1;
  EXPECT_EQ(reason_of(encoded(message)), "checksum");
  message = three_points_message(0, 1);
  EXPECT_EQ(reason_of(encoded(message)), "time");
  EXPECT_EQ(reason_of(encoded(three_points_message(5, 1)), 35), "too_large");
  auto bytes = encoded(three_points_message(5, 1));
  bytes.push_back(0);
  EXPECT_EQ(reason_of(bytes), "size");
}

TEST(ScanCodec, UnknownTypeNamesTheFingerprintsThatAreKnown) {
  auto message = encoded(pose_message(5));
  message[0] ^= 1;
  const auto scan = decode_scan(message, kMaxBytes);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().reason, "unknown_type");
  EXPECT_NE(scan.error().message.find("0x2f16efb052b0105e is none of the types that carry scans: "
                                      "planemap_lcm.depth_scan_t (0x"),
            std::string::npos)
      << scan.error().message;
  EXPECT_NE(scan.error().message.find("drake.lcmt_point_cloud (0x17f2c128b5d25a95)"), std::string::npos);
}

TEST(ScanCodec, APoseAmongScansIsToldFromAnUnknownType) {
  const auto scan = decode_scan(encoded(pose_message(5)), kMaxBytes);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().reason, "wrong_channel");
  EXPECT_EQ(scan.error().message,
            "bot_core.pose_t (0x2e16efb052b0105e) is a pose, which belongs on inputs[].pose_channel");
}

TEST(PoseCodec, PoseComesBackNormalised) {
  auto message = pose_message(77, 1.5);
  message.pos[2] = -0.5;
  message.orientation[0] = 0.7071;  // three digits are taken
  message.orientation[3] = 0.7071;
  message.vel[0] = std::numeric_limits<double>::quiet_NaN();  // velocities are nobody's business
  const auto pose = decode_pose(encoded(message));
  ASSERT_TRUE(pose) << pose.error().message;
  EXPECT_EQ(pose->utime, 77);
  EXPECT_EQ(pose->p_world_m, Eigen::Vector3d(1.5, 0.0, -0.5));
  EXPECT_NEAR(pose->q_world_body.norm(), 1.0, 1e-15);
  EXPECT_NEAR((pose->q_world_body * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-12);
}

TEST(PoseCodec, RejectsWhatIsNoPose) {
  struct Case {
    const char* reason;
    std::function<void(bot_core::pose_t&)> spoil;
  };
  const Case cases[] = {
      {"time", [](auto& m) { m.utime = 0; }},
      {"not_finite", [](auto& m) { m.pos[1] = std::numeric_limits<double>::infinity(); }},
      {"not_finite", [](auto& m) { m.pos[1] = 1e12; }},
      {"quaternion", [](auto& m) { m.orientation[0] = 0.0; }},
      {"quaternion", [](auto& m) { m.orientation[0] = 1.01; }},
      {"quaternion", [](auto& m) { m.orientation[2] = std::numeric_limits<double>::quiet_NaN(); }},
  };
  for (const auto& c : cases) {
    auto message = pose_message(5);
    c.spoil(message);
    const auto pose = decode_pose(encoded(message));
    ASSERT_FALSE(pose) << &c - cases;
    EXPECT_EQ(pose.error().reason, c.reason);
  }
  auto bytes = encoded(pose_message(5));
  bytes.pop_back();
  EXPECT_EQ(decode_pose(bytes).error().reason, "size");
  const auto scan = decode_pose(encoded(wall_message(5, 1)));
  EXPECT_EQ(scan.error().reason, "wrong_channel");
  EXPECT_NE(scan.error().message.find(") is a scan, which belongs on inputs[].channel"), std::string::npos);
  EXPECT_EQ(decode_pose({}).error().reason, "unknown_type");
}

}  // namespace
}  // namespace planemap::service

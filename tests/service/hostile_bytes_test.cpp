// Bytes that nobody should send. This program counts its allocations: none may be larger than a message justifies.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#include <random>

#include "codec/pose_codec.hpp"
#include "codec/request_codec.hpp"
#include "codec/scan_codec.hpp"
#include "formats/field_formats.hpp"
#include "support/messages.hpp"

namespace {
std::atomic<std::size_t> g_largest_allocation{0};

void* allocate(std::size_t size) {
  std::size_t largest = g_largest_allocation.load();
  while (size > largest && !g_largest_allocation.compare_exchange_weak(largest, size)) {
  }
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace planemap::service {
namespace {

constexpr std::size_t kMaxBytes = 1 << 20;
/// What decoding may take beside the message's own size: texts of errors, vectors' slack.
constexpr std::size_t kSlack = 4096;

/// Runs every decoder over the bytes. @return how many of them took the message
int decode_all(const Bytes& bytes) {
  static const ScanFormat format = [] {
    ScanFormat all;
    all.intrinsics = PinholeIntrinsics{0, 0, 75.0, 75.0, 40.0, 30.0};
    all.disparity = DisparityCalibration{0.075, 1090.0};
    return all;
  }();
  int taken = 0;
  taken += decode_scan(bytes, kMaxBytes, format).has_value() ? 1 : 0;
  taken += decode_pose(bytes).has_value() ? 1 : 0;
  taken += decode_request(bytes).has_value() ? 1 : 0;
  return taken;
}

/// A request with something in every list.
Bytes full_request() {
  auto request = request_message(planemap_lcm::request_t::OPERATION_NEAREST);
  request.filter.classes = {"wall", "floor"};
  request.filter.n_classes = 2;
  planemap_lcm::nearest_query_t nearest{};
  nearest.points.resize(3);
  nearest.n_points = 3;
  request.nearest = {nearest};
  planemap_lcm::rays_query_t rays{};
  rays.rays.resize(2);
  rays.n_rays = 2;
  request.rays = {rays};
  request.region.resize(1);
  request.plane.resize(1);
  request.floorplan.resize(1);
  request.n_nearest = request.n_rays = request.n_region = request.n_plane = request.n_floorplan = 1;
  return encoded(request);
}

/// A wall of 80 x 60 pixels in the types of other stacks.
std::vector<Bytes> field_messages() {
  namespace bridge = kinect_bridge;
  DepthScan wall;
  wall.utime = 5;
  wall.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
  wall.depth.assign(80 * 60, 1000);
  auto packed = bridge::to_kinect_disparity(wall, bridge::Encoding::kRaw);
  packed.depth.depth_data_format = kinect::depth_msg_t::DEPTH_11BIT_PACKED;
  packed.depth.depth_data.resize(80 * 60 * 11 / 8);
  packed.depth.depth_data_nbytes = static_cast<std::int32_t>(packed.depth.depth_data.size());
  return {encoded(bridge::to_kinect_frame(wall, bridge::Encoding::kRaw)),
          encoded(bridge::to_kinect_frame(wall, bridge::Encoding::kZlib)),
          encoded(bridge::to_kinect_disparity(wall, bridge::Encoding::kZlib)),
          encoded(packed),
          encoded(bridge::to_images(wall, bridge::Encoding::kZlib)),
          encoded(bridge::to_image(wall)),
          encoded(bridge::to_image_array(wall, bridge::DrakePixels::kUint16, bridge::Encoding::kPng)),
          encoded(bridge::to_image_array(wall, bridge::DrakePixels::kFloat32, bridge::Encoding::kZlib)),
          encoded(bridge::to_pointcloud2(wall)),
          encoded(bridge::to_point_cloud(wall)),
          encoded(bridge::to_rigid_transform(Eigen::Isometry3d::Identity(), 5))};
}

std::vector<Bytes> good_messages() {
  std::vector<Bytes> messages = {encoded(wall_message(5, 1)),
                                 encoded(zipped(wall_message(5, 1))),
                                 encoded(three_points_message(5, 1)),
                                 encoded(pose_message(5)),
                                 encoded(pose_cov_message(5, 1.0, 0.01, 0.002)),
                                 encoded(request_message(1)),
                                 full_request()};
  for (auto& message : field_messages()) messages.push_back(std::move(message));
  return messages;
}

void put_i32(Bytes& bytes, std::size_t at, std::int32_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(word >> (24 - 8 * i));
}

TEST(HostileBytes, GoodMessagesAreTaken) {
  for (const auto& message : good_messages()) EXPECT_EQ(decode_all(message), 1);
}

TEST(HostileBytes, NoTruncationIsTaken) {
  for (const auto& message : good_messages()) {
    for (std::size_t size = 0; size < message.size(); ++size) {
      ASSERT_EQ(decode_all(Bytes(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(size))), 0) << size;
    }
  }
}

TEST(HostileBytes, RandomFlipsTakeNoMemoryBeyondTheMessage) {
  std::mt19937_64 random(7);
  int decoded = 0;
  for (const auto& message : good_messages()) {
    for (int round = 0; round < 4000; ++round) {
      Bytes bytes = message;
      // Mostly in the first hundred bytes, where the counts are.
      const std::size_t reach = round % 4 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 100);
      for (std::uint64_t flips = 1 + random() % 4; flips > 0; --flips) {
        bytes[8 + random() % (reach - 8)] ^= static_cast<std::uint8_t>(1U << (random() % 8));
      }
      g_largest_allocation = 0;
      decode_all(bytes);
      ASSERT_LE(g_largest_allocation.load(), kMaxBytes + kSlack);
      ++decoded;
    }
  }
  EXPECT_EQ(decoded, 72000);
}

TEST(HostileBytes, CountsOfEveryKindAreRefusedBeforeMemoryIsTaken) {
  int refused = 0;
  for (const auto& message : good_messages()) {
    // Compressed pixels may need the most that deflate can pack; nothing else may need more than the message's own
    // size, but that disparities of 11 bits become 16.
    const bool is_compressed = message.size() < 4800;
    const std::size_t most = (is_compressed ? 1032 * message.size() : message.size() * 3 / 2) + kSlack;
    for (std::size_t at = 8; at + 4 <= std::min<std::size_t>(message.size(), 120); ++at) {
      for (const std::int32_t count : {-1, 0x7fffffff, -0x7fffffff - 1, 0x10000000, 30000000}) {
        Bytes bytes = message;
        put_i32(bytes, at, count);
        g_largest_allocation = 0;
        if (decode_all(bytes) == 0) ++refused;
        ASSERT_LE(g_largest_allocation.load(), most) << "count " << count << " at " << at;
      }
    }
  }
  EXPECT_GT(refused, 500);
}

TEST(HostileBytes, NoFlipMakesACovarianceThatIsNone) {
  std::mt19937_64 random(13);
  const Bytes message = encoded(pose_cov_message(5, 1.0, 0.01, 0.002));
  int taken = 0;
  int refused = 0;
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes = message;
    for (std::uint64_t flips = 1 + random() % 4; flips > 0; --flips) {
      bytes[8 + random() % (bytes.size() - 8)] ^= static_cast<std::uint8_t>(1U << (random() % 8));
    }
    const auto pose = decode_pose(bytes);
    ++(pose ? taken : refused);
    if (!pose || !pose->covariance) continue;
    const PoseCovariance& x = *pose->covariance;
    ASSERT_TRUE(x.allFinite());
    const PoseCovariance factor = cholesky_factor(x);
    ASSERT_TRUE(factor.allFinite());
    ASSERT_TRUE((factor * factor.transpose()).isApprox(x, 1e-6)) << x;
    ASSERT_LE(x.diagonal().maxCoeff(), 100.1);
  }
  EXPECT_GT(taken, 500);
  EXPECT_GT(refused, 500);
}

TEST(HostileBytes, ZipBombIsBoundedByTheImageItSaysItIs) {
  auto bomb = wall_message(5, 1);
  bomb.data.assign(64 << 20, 0);
  bomb = zipped(bomb);
  const Bytes bytes = encoded(bomb);
  g_largest_allocation = 0;
  const auto scan = decode_scan(bytes, kMaxBytes);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().reason, "encoding");
  EXPECT_LE(g_largest_allocation.load(), 9600u + kSlack);
}

TEST(HostileBytes, RandomNoiseBehindEachFingerprintIsRefused) {
  std::mt19937_64 random(11);
  for (const auto& message : good_messages()) {
    for (int round = 0; round < 500; ++round) {
      Bytes bytes(8 + random() % 300);
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      std::copy_n(message.begin(), 8, bytes.begin());
      ASSERT_EQ(decode_all(bytes), 0);
    }
  }
}

}  // namespace
}  // namespace planemap::service

// Undecodable and hostile messages on every channel that planemapd listens to, and hand-made datagrams past the LCM
// library.
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <planemap_lcm/point_scan_t.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <random>
#include <string>
#include <vector>

#include "formats/field_formats.hpp"
#include "formats/pixels.hpp"
#include "harness/messages.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

constexpr std::size_t kDepthSizeAt = 69;    // where depth_scan_t has its size, behind fingerprint and header
constexpr std::size_t kPointValuesAt = 20;  // where point_scan_t has n_values
constexpr std::int64_t kUtime = 1'700'000'000'000'000;

Bytes random_bytes(std::mt19937& random, std::size_t size) {
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

/// The message cut short at sixteen places.
void add_truncations(std::vector<Bytes>& messages, const Bytes& whole) {
  for (std::size_t i = 0; i < 16; ++i) {
    messages.emplace_back(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() * i / 16));
  }
}

/// 64 MB of zeros behind a header that says 80 x 60 pixels.
Bytes inflating_scan() {
  planemap_lcm::depth_scan_t scan = wall_message(kUtime, 1);
  const Bytes zeros(std::size_t{64} << 20);
  uLongf size = compressBound(zeros.size());
  scan.data.resize(size);
  compress2(scan.data.data(), &size, zeros.data(), zeros.size(), 1);
  scan.data.resize(size);
  scan.encoding = planemap_lcm::depth_scan_t::ENCODING_ZLIB;
  stamp_checksum(scan);
  return encoded(scan);
}

std::vector<Bytes> bad_scans() {
  std::mt19937 random(7);
  std::vector<Bytes> bad;
  for (const std::size_t size : {0u, 1u, 7u, 8u, 9u, 100u, 5000u, 70000u}) bad.push_back(random_bytes(random, size));
  const Bytes good = encoded(wall_message(kUtime, 1));
  add_truncations(bad, good);
  bad.push_back(encoded(pose_message(kUtime)));  // the wrong type for the channel
  planemap_lcm::point_scan_t points{};
  points.utime = kUtime;
  for (const std::int32_t count : {-1, 0x7fffffff, std::numeric_limits<std::int32_t>::min()}) {
    bad.push_back(with_number(good, kDepthSizeAt, count));
    bad.push_back(with_number(encoded(points), kPointValuesAt, count));
  }
  Bytes flipped = good;
  flipped[good.size() / 2] ^= 1;
  bad.push_back(flipped);
  bad.push_back(inflating_scan());
  planemap_lcm::depth_scan_t scan = wall_message(kUtime, 1);
  scan.width = scan.height = 0x7fffffff;
  bad.push_back(encoded(scan));
  scan = wall_message(kUtime, 1);
  scan.fx = std::nan("");
  bad.push_back(encoded(scan));
  return bad;
}

/// 64 MB of zeros where the message says 80 x 60 pixels.
std::vector<std::uint8_t> inflating_bytes() {
  return kinect_bridge::deflated(Bytes(std::size_t{64} << 20));
}

/// What other stacks' types can bring that is no scan.
std::vector<Bytes> bad_field_scans() {
  namespace bridge = kinect_bridge;
  DepthScan wall;
  wall.utime = kUtime;
  wall.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
  wall.depth.assign(80 * 60, 1000);
  std::mt19937 random(11);
  std::vector<Bytes> bad;
  for (const Bytes& good :
       {encoded(bridge::to_kinect_frame(wall, bridge::Encoding::kZlib)),
        encoded(bridge::to_images(wall, bridge::Encoding::kZlib)), encoded(bridge::to_image(wall)),
        encoded(bridge::to_image_array(wall, bridge::DrakePixels::kUint16, bridge::Encoding::kPng)),
        encoded(bridge::to_image_array(wall, bridge::DrakePixels::kFloat32, bridge::Encoding::kRaw)),
        encoded(bridge::to_pointcloud2(wall)), encoded(bridge::to_point_cloud(wall))}) {
    add_truncations(bad, good);
    for (const std::size_t size : {1u, 60u, 2000u}) {
      Bytes noise = random_bytes(random, 8 + size);
      std::copy_n(good.begin(), 8, noise.begin());
      bad.push_back(noise);
    }
  }
  auto frame = bridge::to_kinect_frame(wall, bridge::Encoding::kZlib);
  frame.depth.depth_data = inflating_bytes();
  frame.depth.depth_data_nbytes = static_cast<std::int32_t>(frame.depth.depth_data.size());
  bad.push_back(encoded(frame));
  auto images = bridge::to_images(wall, bridge::Encoding::kZlib);
  images.images[1].data = inflating_bytes();
  images.images[1].size = static_cast<std::int32_t>(images.images[1].data.size());
  bad.push_back(encoded(images));
  images.images[1].width = images.images[1].height = 4096;
  images.images[1].row_stride = 0x7fffffff;
  bad.push_back(encoded(images));
  bad.push_back(encoded(bridge::to_kinect_disparity(wall, bridge::Encoding::kRaw)));  // no calibration
  bad.push_back(encoded(bridge::to_rigid_transform(Eigen::Isometry3d::Identity(), kUtime)));
  return bad;
}

void add_bad_covariances(std::vector<Bytes>& bad) {
  const pronto::rigid_body_pose_cov_t good = pose_cov_message(kUtime, 0.0, 0.01, 0.002);
  add_truncations(bad, encoded(good));
  constexpr int kVariance = 21;    // of the position along x
  constexpr int kCovariance = 22;  // of the positions along x and y, above the diagonal
  for (const double number : {-1e-4, std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    for (const int at : {kVariance, kCovariance}) {
      pronto::rigid_body_pose_cov_t pose = good;
      pose.pose_cov[at] = number;
      bad.push_back(encoded(pose));
    }
  }
  pronto::rigid_body_pose_cov_t pose = good;
  pose.active_indices[4] = 0;
  bad.push_back(encoded(pose));
}

std::vector<Bytes> bad_poses() {
  std::mt19937 random(8);
  std::vector<Bytes> bad;
  for (const std::size_t size : {0u, 7u, 9u, 136u, 5000u}) bad.push_back(random_bytes(random, size));
  add_truncations(bad, encoded(pose_message(kUtime)));
  bad.push_back(encoded(wall_message(kUtime, 1)));
  bot_core::pose_t pose = pose_message(kUtime);
  pose.orientation[0] = 0.0;
  bad.push_back(encoded(pose));
  pose = pose_message(kUtime);
  pose.pos[1] = std::numeric_limits<double>::quiet_NaN();
  bad.push_back(encoded(pose));
  add_bad_covariances(bad);
  return bad;
}

std::vector<Bytes> bad_requests() {
  std::mt19937 random(9);
  std::vector<Bytes> bad;
  for (const std::size_t size : {0u, 7u, 9u, 60u, 5000u}) bad.push_back(random_bytes(random, size));
  planemap_lcm::request_t request = request_message(planemap_lcm::request_t::OPERATION_STATUS, 1);
  add_truncations(bad, encoded(request));
  request.reply_channel = "POSE";  // the service is no one's loudspeaker
  bad.push_back(encoded(request));
  request = request_message(planemap_lcm::request_t::OPERATION_STATUS, 2);
  bad.push_back(with_number(encoded(request), 24, 0x7fffffff));  // length of the reply channel's name
  return bad;
}

/// Greatest memory of a process so far, bytes.
std::int64_t peak_memory(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  std::string word;
  while (file >> word) {
    if (word == "VmHWM:") {
      std::int64_t kilobytes = 0;
      file >> kilobytes;
      return kilobytes * 1024;
    }
  }
  return -1;
}

/// Keeps the replies it hears.
struct ReplyEar {
  void on_reply(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                const planemap_lcm::reply_t* reply) {
    replies.push_back(*reply);
  }
  std::vector<planemap_lcm::reply_t> replies;
};

class Hostile : public SystemTest {
 protected:
  void publish(const std::string& channel, const std::vector<Bytes>& messages) {
    for (const Bytes& message : messages) {
      bus_->lcm().publish(channel, message.data(), static_cast<unsigned>(message.size()));
      bus_->listen_for(2ms);
    }
  }

  /// Sends good scans and poses until so many more are mapped.
  void expect_good_scans_are_mapped() {
    const std::int64_t wanted = bus_->counter("scans.mapped") + 5;
    std::int64_t utime = kUtime + 1'000'000 * ++rounds_;
    std::int32_t seq = 0;
    const bool mapped = bus_->wait_until(
        [&] {
          const bot_core::pose_t pose = pose_message(utime);
          const planemap_lcm::depth_scan_t scan = wall_message(utime, ++seq);
          bus_->lcm().publish("POSE", &pose);
          bus_->lcm().publish("PLANEMAP_SCAN", &scan);
          utime += 33'333;
          return bus_->counter("scans.mapped") >= wanted || !daemon_->running();
        },
        20s);
    EXPECT_TRUE(daemon_->running()) << "planemapd died";
    EXPECT_TRUE(mapped) << "good scans are not mapped any more";
  }

  /// Each scan is somewhere.
  void expect_scans_add_up() {
    EXPECT_EQ(bus_->counter("scans.received"), bus_->counter("scans.mapped") + bus_->counter("scans.waiting") +
                                                   bus_->counters_beginning("scans.dropped.") +
                                                   bus_->counters_beginning("scans.rejected."));
  }

  int rounds_ = 0;
};

TEST_F(Hostile, BadScansAreRejectedCountedAndCostNoMemory) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  expect_good_scans_are_mapped();
  const std::int64_t memory = peak_memory(daemon_->pid());
  ASSERT_GT(memory, 0);
  const std::vector<Bytes> bad = bad_scans();
  publish("PLANEMAP_SCAN", bad);
  const auto expected = static_cast<std::int64_t>(bad.size());
  EXPECT_TRUE(bus_->wait_until([&] { return bus_->counters_beginning("scans.rejected.") >= expected; }, 10s));
  EXPECT_EQ(bus_->counters_beginning("scans.rejected."), expected);
  expect_good_scans_are_mapped();
  expect_scans_add_up();
  EXPECT_LT(peak_memory(daemon_->pid()), memory + (std::int64_t{64} << 20));
}

TEST_F(Hostile, BadScansOfOtherStacksAreRejectedCountedAndCostNoMemory) {
  ASSERT_NO_FATAL_FAILURE(start_daemon({"--set", "inputs.0.intrinsics=[75, 75, 40, 30]"}));
  expect_good_scans_are_mapped();
  const std::int64_t memory = peak_memory(daemon_->pid());
  const std::vector<Bytes> bad = bad_field_scans();
  ASSERT_EQ(bad.size(), 7u * 19u + 5u);
  publish("PLANEMAP_SCAN", bad);
  const auto expected = static_cast<std::int64_t>(bad.size());
  EXPECT_TRUE(bus_->wait_until([&] { return bus_->counters_beginning("scans.rejected.") >= expected; }, 10s));
  EXPECT_EQ(bus_->counters_beginning("scans.rejected."), expected);
  EXPECT_EQ(bus_->counter("scans.rejected.disparity"), 1);
  EXPECT_EQ(bus_->counter("scans.rejected.wrong_channel"), 1);
  EXPECT_EQ(bus_->counter("scans.rejected.too_large"), 1);
  expect_good_scans_are_mapped();
  expect_scans_add_up();
  EXPECT_LT(peak_memory(daemon_->pid()), memory + (std::int64_t{64} << 20));
}

TEST_F(Hostile, BadPosesAreRejectedAndCounted) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  const std::vector<Bytes> bad = bad_poses();
  publish("POSE", bad);
  const auto expected = static_cast<std::int64_t>(bad.size());
  EXPECT_TRUE(bus_->wait_until([&] { return bus_->counters_beginning("poses.rejected.") >= expected; }, 10s));
  EXPECT_EQ(bus_->counters_beginning("poses.rejected."), expected);
  expect_good_scans_are_mapped();
}

TEST_F(Hostile, BadRequestsDoNotKeepGoodOnesFromAnAnswer) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  ReplyEar ear;
  bus_->lcm().subscribe("PLANEMAP_REPLY_TEST", &ReplyEar::on_reply, &ear);
  const std::vector<planemap_lcm::reply_t>& replies = ear.replies;
  publish("PLANEMAP_REQUEST", bad_requests());
  const planemap_lcm::request_t request = request_message(planemap_lcm::request_t::OPERATION_STATUS, 77);
  bus_->lcm().publish("PLANEMAP_REQUEST", &request);
  const auto answered = [&] {
    return !replies.empty() && replies.back().request_id == 77 &&
           replies.back().status == planemap_lcm::reply_t::STATUS_OK;
  };
  EXPECT_TRUE(bus_->wait_until(answered, 10s));
  planemap_lcm::request_t unknown = request_message(planemap_lcm::request_t::OPERATION_STATUS, 78);
  unknown.operation = 999;
  bus_->lcm().publish("PLANEMAP_REQUEST", &unknown);
  EXPECT_TRUE(bus_->wait_until([&] { return !replies.empty() && replies.back().request_id == 78; }, 10s));
  ASSERT_FALSE(replies.empty());
  EXPECT_EQ(replies.back().status, planemap_lcm::reply_t::STATUS_UNKNOWN_OPERATION);
  EXPECT_NE(replies.back().error, "") << "an error reply says what is wrong";
  expect_good_scans_are_mapped();
}

TEST_F(Hostile, HandMadeDatagramsDoNoHarm) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  std::mt19937 random(10);
  RawSender sender;
  const Bytes scan = encoded(wall_message(kUtime, 1));
  for (const std::size_t size : {1u, 4u, 7u, 20u, 1400u}) sender.send(random_bytes(random, size));
  const Bytes whole = short_datagram("PLANEMAP_SCAN", Bytes(scan.begin(), scan.begin() + 1000), 1);
  for (const std::size_t size : {4u, 8u, 9u, 15u, 21u}) {  // cut within the header and the channel's name
    sender.send(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  sender.send(short_datagram(std::string(100, 'C'), scan, 2));  // a name longer than LCM allows
  // A fragment that comes twice passes for the two fragments of a message: its second half is whatever memory held.
  const Bytes half(scan.begin(), scan.begin() + static_cast<std::ptrdiff_t>(scan.size() / 2));
  for (std::uint32_t sequence = 10; sequence < 20; ++sequence) {
    const Bytes first =
        fragment_datagram({sequence, static_cast<std::uint32_t>(scan.size()), 0, 0, 2}, "PLANEMAP_SCAN", half);
    sender.send(first);
    sender.send(first);
    bus_->listen_for(2ms);
  }
  EXPECT_TRUE(bus_->wait_until([&] { return bus_->counters_beginning("scans.rejected.") >= 10; }, 10s))
      << "the half messages of twice-sent fragments are rejected by their checksum";
  EXPECT_EQ(bus_->counter("scans.mapped"), 0);
  expect_good_scans_are_mapped();
  expect_scans_add_up();
}

}  // namespace
}  // namespace planemap::system_test

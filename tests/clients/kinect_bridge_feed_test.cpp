#include <gtest/gtest.h>
#include <zlib.h>

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "feed.hpp"
#include "looped_source.hpp"

namespace planemap::kinect_bridge {
namespace {

using std::chrono::steady_clock;

/// Frames 40 ms apart, each 1 m and 0.2 rad about z farther.
class Frames final : public sources::FrameSource {
 public:
  explicit Frames(int count) {
    for (int k = 0; k < count; ++k) {
      sources::Frame frame;
      frame.scan.utime = 5'000'000 + 40'000 * k;
      frame.scan.intrinsics = {3, 2, 10.0, 11.0, 1.0, 0.5};
      frame.scan.depth = {0, 1, 258, 65535, 4660, static_cast<std::uint16_t>(1000 + k)};
      frame.T_world_sensor.translation().x() = k;
      frame.T_world_sensor.linear() = Eigen::AngleAxisd(0.2 * k, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      frames_.push_back(std::move(frame));
    }
    skipped_["torn"] = 1;
  }
  std::optional<sources::Frame> next() override {
    if (frames_.empty()) return std::nullopt;
    auto frame = std::move(frames_.front());
    frames_.pop_front();
    return frame;
  }
  std::optional<std::size_t> size() const override { return frames_.size(); }
  const std::map<std::string, std::size_t>& skipped() const override { return skipped_; }
  std::optional<Eigen::Vector3d> gravity_direction() const override { return std::nullopt; }

 private:
  std::deque<sources::Frame> frames_;
  std::map<std::string, std::size_t> skipped_;
};

struct Message {
  std::string channel;
  std::int64_t utime = 0;
  std::vector<std::uint8_t> bytes;
};

/// Keeps what it gets; refuses some messages.
class Kept final : public Sink {
 public:
  Expected<void> put(const std::string& channel, std::int64_t utime, std::span<const std::uint8_t> bytes) override {
    if (refuse_from <= count && count < refuse_until) {
      ++count;
      return fail("refused");
    }
    ++count;
    messages.push_back({channel, utime, {bytes.begin(), bytes.end()}});
    return {};
  }
  std::vector<Message> messages;
  int count = 0;
  int refuse_from = 0;
  int refuse_until = 0;
};

template <class Type>
Type decoded(const Message& message) {
  Type value{};
  const int size = static_cast<int>(message.bytes.size());
  EXPECT_EQ(value.decode(message.bytes.data(), 0, size), size);
  return value;
}

/// Never waits, never stops.
bool go_on(steady_clock::time_point) {
  return false;
}

Expected<FeedReport> feed(Sink& sink, int frames, FeedOptions options, const WaitUntil& wait = go_on) {
  Frames source(frames);
  return Feed(source, sink, options, wait).run([](const FeedReport&) {});
}

std::vector<std::uint8_t> inflated(const planemap_lcm::depth_scan_t& scan) {
  std::vector<std::uint8_t> raw(static_cast<std::size_t>(scan.width) * scan.height * 2);
  uLongf size = raw.size();
  EXPECT_EQ(uncompress(raw.data(), &size, scan.data.data(), scan.data.size()), Z_OK);
  EXPECT_EQ(size, raw.size());
  return raw;
}

TEST(Feed, SendsEachFramesPoseThenItsScan) {
  Kept sink;
  const auto report = feed(sink, 3, {});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->frames, 3u);
  EXPECT_EQ(report->poses, 3u);
  EXPECT_EQ(report->first_utime, 5'000'000);
  EXPECT_EQ(report->last_utime, 5'080'000);
  ASSERT_EQ(sink.messages.size(), 6u);
  for (int k = 0; k < 3; ++k) {
    const Message& pose_message = sink.messages[2 * static_cast<std::size_t>(k)];
    const Message& scan_message = sink.messages[2 * static_cast<std::size_t>(k) + 1];
    EXPECT_EQ(pose_message.channel, "POSE");
    EXPECT_EQ(scan_message.channel, "PLANEMAP_SCAN");
    const auto pose = decoded<bot_core::pose_t>(pose_message);
    const auto scan = decoded<planemap_lcm::depth_scan_t>(scan_message);
    for (const std::int64_t utime : {pose.utime, scan.utime, pose_message.utime, scan_message.utime}) {
      EXPECT_EQ(utime, 5'000'000 + 40'000 * k);
    }
    EXPECT_EQ(scan.seq, k);
    EXPECT_NEAR(pose.pos[0], k, 1e-12);
    EXPECT_NEAR(pose.orientation[0], std::cos(0.1 * k), 1e-12);
    EXPECT_NEAR(pose.orientation[3], std::sin(0.1 * k), 1e-12);
    EXPECT_DOUBLE_EQ(scan.fy, 11.0);
    EXPECT_DOUBLE_EQ(scan.depth_scale_m, 0.001);
  }
}

TEST(Feed, ScansHoldTheSameDepthRawAndCompressed) {
  for (const Encoding encoding : {Encoding::kRaw, Encoding::kZlib}) {
    Kept sink;
    FeedOptions options;
    options.format.encoding = encoding;
    ASSERT_TRUE(feed(sink, 1, options));
    const auto scan = decoded<planemap_lcm::depth_scan_t>(sink.messages.at(1));
    EXPECT_EQ(scan.size, static_cast<std::int32_t>(scan.data.size()));
    EXPECT_EQ(static_cast<std::uint32_t>(scan.crc32), crc32(0, scan.data.data(), static_cast<uInt>(scan.data.size())));
    const bool raw = encoding == Encoding::kRaw;
    EXPECT_EQ(scan.encoding,
              raw ? planemap_lcm::depth_scan_t::ENCODING_RAW : planemap_lcm::depth_scan_t::ENCODING_ZLIB);
    const std::vector<std::uint8_t> expected = {0, 0, 1, 0, 2, 1, 255, 255, 0x34, 0x12, 0xe8, 0x03};
    EXPECT_EQ(raw ? scan.data : inflated(scan), expected);
  }
}

TEST(Feed, InterpolatesPosesBetweenFrames) {
  Kept sink;
  FeedOptions options;
  options.pose_rate_hz = 100.0;  // frames are 40 ms apart: three poses in between
  const auto report = feed(sink, 3, options);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->poses, 3u + 2u * 3u);
  const auto between = decoded<bot_core::pose_t>(sink.messages.at(2));
  EXPECT_EQ(between.utime, 5'010'000);
  EXPECT_NEAR(between.pos[0], 0.25, 1e-9);
  EXPECT_NEAR(between.orientation[3], std::sin(0.025), 1e-9);
  std::int64_t last = 0;
  for (const Message& message : sink.messages) {
    EXPECT_GE(message.utime, last) << "out of order";
    last = message.utime;
  }
}

TEST(Feed, WaitsForEachFramesTime) {
  Kept sink;
  std::vector<steady_clock::time_point> times;
  FeedOptions options;
  options.rate_hz = 20.0;
  ASSERT_TRUE(feed(sink, 3, options, [&times](steady_clock::time_point time) {
    times.push_back(time);
    return false;
  }));
  ASSERT_EQ(times.size(), 3u);
  EXPECT_EQ(times[1] - times[0], std::chrono::milliseconds(50));
  EXPECT_EQ(times[2] - times[0], std::chrono::milliseconds(100));
  EXPECT_EQ(sink.messages.back().utime, 5'080'000) << "recorded times stay as they are";
}

TEST(Feed, StampsWithTheWallClockWhereAsked) {
  Kept sink;
  FeedOptions options;
  options.wall_clock = true;
  const auto now = [] {
    return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  const std::int64_t before = now();
  const auto report = feed(sink, 2, options);
  ASSERT_TRUE(report);
  EXPECT_GE(report->first_utime, before);
  EXPECT_LE(report->first_utime, now());
  EXPECT_EQ(report->last_utime - report->first_utime, 40'000);
}

TEST(Feed, EndsWhenItIsStoppedOrHasEnough) {
  Kept stopped_sink;
  int waits = 0;
  const auto stopped = feed(stopped_sink, 9, {}, [&waits](steady_clock::time_point) { return ++waits > 4; });
  ASSERT_TRUE(stopped);
  EXPECT_TRUE(stopped->stopped);
  EXPECT_EQ(stopped->frames, 4u);
  Kept sink;
  FeedOptions options;
  options.frames = 2;
  const auto enough = feed(sink, 9, options);
  ASSERT_TRUE(enough);
  EXPECT_FALSE(enough->stopped);
  EXPECT_EQ(enough->frames, 2u);
}

TEST(Feed, FailsIfNothingCanBeSentButSurvivesLosses) {
  Kept dead;
  dead.refuse_until = 1000;
  const auto nothing = feed(dead, 3, {});
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().message, "refused");
  Kept shaky;
  shaky.refuse_from = 2;
  shaky.refuse_until = 4;
  const auto report = feed(shaky, 3, {});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->unsent, 2u);
  EXPECT_EQ(shaky.messages.size(), 4u);
  Kept full;  // a log, on a disk that is full
  full.refuse_from = 2;
  full.refuse_until = 1000;
  FeedOptions log;
  log.paced = false;
  EXPECT_FALSE(feed(full, 3, log));
}

TEST(LoopedSource, GoesOnWithTheTimesOfTheRoundBefore) {
  auto source = LoopedSource::open(
      []() -> Expected<std::unique_ptr<sources::FrameSource>> { return std::make_unique<Frames>(2); });
  ASSERT_TRUE(source);
  std::vector<std::int64_t> utimes;
  for (int k = 0; k < 5; ++k) {
    const auto frame = (*source)->next();
    ASSERT_TRUE(frame);
    EXPECT_NEAR(frame->T_world_sensor.translation().x(), k % 2, 1e-12);
    utimes.push_back(frame->scan.utime);
  }
  EXPECT_EQ(utimes, (std::vector<std::int64_t>{5'000'000, 5'040'000, 5'080'000, 5'120'000, 5'160'000}));
  EXPECT_EQ((*source)->skipped().at("torn"), 3u);
}

TEST(LoopedSource, EndsWhereThereIsNothingToRepeat) {
  auto source = LoopedSource::open(
      []() -> Expected<std::unique_ptr<sources::FrameSource>> { return std::make_unique<Frames>(0); });
  ASSERT_TRUE(source);
  EXPECT_FALSE((*source)->next());
}

}  // namespace
}  // namespace planemap::kinect_bridge

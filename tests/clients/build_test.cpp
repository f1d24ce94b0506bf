#include <gtest/gtest.h>

#include <stdexcept>

#include "build/build_summary.hpp"
#include "build/frame_prefetcher.hpp"

namespace planemap::cli {
namespace {

/// Frames of utime 1, 2, ... `count`; every third one is passed over; after the last it ends, or throws.
class CountingSource final : public sources::FrameSource {
 public:
  explicit CountingSource(int count, bool throws = false) : count_(count), throws_(throws) {}

  std::optional<sources::Frame> next() override {
    ++at_;
    if (at_ % 3 == 0) {
      ++skipped_["every third"];
      ++at_;
    }
    if (at_ > count_ && throws_) throw std::runtime_error("the disk is gone");
    if (at_ > count_) return std::nullopt;
    sources::Frame frame;
    frame.scan.utime = at_;
    return frame;
  }
  std::optional<std::size_t> size() const override { return std::nullopt; }
  const std::map<std::string, std::size_t>& skipped() const override { return skipped_; }
  std::optional<Eigen::Vector3d> gravity_direction() const override { return std::nullopt; }

 private:
  int count_;
  bool throws_;
  int at_ = 0;
  std::map<std::string, std::size_t> skipped_;
};

TEST(FramePrefetcher, GivesTheSourcesFramesInOrder) {
  CountingSource source(100);
  FramePrefetcher frames(source);
  CountingSource twin(100);
  std::size_t count = 0;
  while (const auto expected = twin.next()) {
    const auto frame = frames.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->scan.utime, expected->scan.utime);
    EXPECT_EQ(frames.skipped(), twin.skipped()) << "frames read ahead do not count";
    ++count;
  }
  EXPECT_EQ(count, 67u);
  EXPECT_FALSE(frames.next());
  EXPECT_FALSE(frames.next());
  EXPECT_EQ(frames.skipped(), twin.skipped());
}

TEST(FramePrefetcher, MayBeLeftWithFramesUnread) {
  CountingSource source(1'000'000);
  FramePrefetcher frames(source);
  EXPECT_TRUE(frames.next());
}

TEST(FramePrefetcher, ThrowsWhatTheSourceThrewAfterTheFramesBefore) {
  CountingSource source(2, /*throws=*/true);
  FramePrefetcher frames(source);
  EXPECT_TRUE(frames.next());
  EXPECT_TRUE(frames.next());
  EXPECT_THROW(frames.next(), std::runtime_error);
}

TEST(SpreadOf, TakesTheNearestRank) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Spread spread = spread_of(values);
  EXPECT_EQ(spread.p50, 50.0);
  EXPECT_EQ(spread.p95, 95.0);
  EXPECT_EQ(spread.max, 100.0);
  EXPECT_EQ(spread_of({7.0}).p50, 7.0);
  EXPECT_EQ(spread_of({7.0}).p95, 7.0);
  EXPECT_EQ(spread_of({}).max, 0.0);
}

}  // namespace
}  // namespace planemap::cli

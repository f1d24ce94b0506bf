#include "looped_source.hpp"

#include <utility>

namespace planemap::kinect_bridge {
namespace {

constexpr std::int64_t kDefaultPeriodUs = 33'333;  // after a recording of a single frame

}  // namespace

LoopedSource::LoopedSource(Open open, std::unique_ptr<sources::FrameSource> source)
    : open_(std::move(open)), source_(std::move(source)) {}

Expected<std::unique_ptr<sources::FrameSource>> LoopedSource::open(const Open& open) {
  auto source = open();
  if (!source) return source;
  return std::unique_ptr<sources::FrameSource>(new LoopedSource(open, std::move(*source)));
}

sources::Frame LoopedSource::shifted(sources::Frame frame) {
  if (first_of_round_) {
    shift_us_ = last_utime_ + (last_period_us_ > 0 ? last_period_us_ : kDefaultPeriodUs) - frame.scan.utime;
    first_of_round_ = false;
  }
  frame.scan.utime += shift_us_;
  if (started_) last_period_us_ = frame.scan.utime - last_utime_;
  last_utime_ = frame.scan.utime;
  started_ = true;
  return frame;
}

std::optional<sources::Frame> LoopedSource::next() {
  if (auto frame = source_->next()) return shifted(std::move(*frame));
  if (!started_) return std::nullopt;
  auto again = open_();
  if (!again) return std::nullopt;  // it was there before: somebody took it away
  for (const auto& entry : source_->skipped()) skipped_before_[entry.first] += entry.second;
  source_ = std::move(*again);
  first_of_round_ = true;
  auto frame = source_->next();
  if (!frame) return std::nullopt;
  return shifted(std::move(*frame));
}

const std::map<std::string, std::size_t>& LoopedSource::skipped() const {
  skipped_ = skipped_before_;
  for (const auto& entry : source_->skipped()) skipped_[entry.first] += entry.second;
  return skipped_;
}

}  // namespace planemap::kinect_bridge

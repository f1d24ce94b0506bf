#include "feed.hpp"

#include <cmath>
#include <utility>

namespace planemap::kinect_bridge {
namespace {

using std::chrono::microseconds;

std::int64_t wall_utime() {
  return std::chrono::duration_cast<microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

Eigen::Isometry3d interpolated(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to, double share) {
  Eigen::Isometry3d between = Eigen::Isometry3d::Identity();
  const Eigen::Quaterniond rotation(from.linear());
  between.linear() = rotation.slerp(share, Eigen::Quaterniond(to.linear())).toRotationMatrix();
  between.translation() = (1.0 - share) * from.translation() + share * to.translation();
  return between;
}

Feed::Feed(sources::FrameSource& source, Sink& sink, const FeedOptions& options, WaitUntil wait)
    : source_(source), sink_(sink), options_(options), wait_(std::move(wait)) {}

std::optional<Feed::Prepared> Feed::prepare() {
  if (options_.frames && prepared_ >= *options_.frames) return std::nullopt;
  auto frame = source_.next();
  if (!frame) return std::nullopt;
  if (prepared_ == 0) first_recorded_utime_ = frame->scan.utime;
  Prepared prepared;
  prepared.offset_us = options_.rate_hz ? std::llround(static_cast<double>(prepared_) / *options_.rate_hz * 1e6)
                                        : frame->scan.utime - first_recorded_utime_;
  if (prepared_ == 0) {
    begin_ = Clock::now();
    first_wall_utime_ = wall_utime();
  }
  prepared.utime = options_.wall_clock ? first_wall_utime_ + prepared.offset_us : frame->scan.utime;
  prepared.T_world_sensor = frame->T_world_sensor;
  prepared.intrinsics = frame->scan.intrinsics;
  frame->scan.utime = prepared.utime;
  prepared.scan = encoded_scan(frame->scan, static_cast<std::int32_t>(prepared_ & 0x7fffffffU), options_.format);
  ++prepared_;
  return prepared;
}

Expected<void> Feed::send(const std::string& channel, std::int64_t utime, const std::vector<std::uint8_t>& bytes) {
  auto sent = sink_.put(channel, utime, bytes);
  if (sent) {
    report_.bytes += bytes.size();
    return {};
  }
  // What was never reached is a mistake to be mended; what is lost on the way may come back.
  if (report_.bytes == 0 || !options_.paced) return sent;
  ++report_.unsent;
  return {};
}

Expected<void> Feed::send_frame(const Prepared& frame) {
  if (auto sent =
          send(options_.pose_channel, frame.utime, encoded_pose(frame.T_world_sensor, frame.utime, options_.format));
      !sent) {
    return sent;
  }
  ++report_.poses;
  if (auto sent = send(options_.channel, frame.utime, frame.scan); !sent) return sent;
  if (report_.frames == 0) report_.first_utime = frame.utime;
  report_.last_utime = frame.utime;
  report_.intrinsics = frame.intrinsics;
  ++report_.frames;
  return {};
}

bool Feed::stop_before(std::int64_t offset_us) {
  const auto time = options_.paced ? begin_ + microseconds(offset_us) : Clock::time_point{};
  report_.stopped = wait_(time);
  return report_.stopped;
}

Expected<void> Feed::send_poses_between(const Prepared& from, const Prepared& to) {
  if (!options_.pose_rate_hz) return {};
  const auto period_us = static_cast<double>(to.offset_us - from.offset_us);
  for (int k = 1;; ++k) {
    const double after_us = k / *options_.pose_rate_hz * 1e6;
    if (after_us >= period_us - 1.0) return {};
    const std::int64_t step_us = std::llround(after_us);
    if (stop_before(from.offset_us + step_us)) return {};
    const auto pose = interpolated(from.T_world_sensor, to.T_world_sensor, after_us / period_us);
    // Between two recorded times where those are published, which --rate may stretch.
    const std::int64_t utime =
        from.utime + std::llround(after_us / period_us * static_cast<double>(to.utime - from.utime));
    if (auto sent = send(options_.pose_channel, utime, encoded_pose(pose, utime, options_.format)); !sent) return sent;
    ++report_.poses;
  }
}

Expected<FeedReport> Feed::run(const std::function<void(const FeedReport&)>& on_frame) {
  auto frame = prepare();
  while (frame) {
    if (stop_before(frame->offset_us)) break;
    const auto lateness = Clock::now() - (begin_ + microseconds(frame->offset_us));
    if (auto sent = send_frame(*frame); !sent) return tl::make_unexpected(sent.error());
    auto next = prepare();
    if (next) {
      if (options_.paced && lateness > microseconds(next->offset_us - frame->offset_us) / 2) ++report_.late;
      if (auto sent = send_poses_between(*frame, *next); !sent) return tl::make_unexpected(sent.error());
    }
    on_frame(report_);
    if (report_.stopped) break;
    frame = std::move(next);
  }
  return report_;
}

}  // namespace planemap::kinect_bridge

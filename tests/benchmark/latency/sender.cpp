#include "latency/sender.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "feed.hpp"
#include "wire.hpp"

namespace planemap::benchmark {

namespace {

using std::chrono::steady_clock;

// Where the first scan lies between two poses, as a share of the poses' period: at 30 and 100 Hz no scan has the time
// of a pose, and they wait for 8.3, 5 and 1.7 ms in turn.
constexpr double kPhase = 1.0 / 6.0;

std::int64_t utime_now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::chrono::microseconds microseconds_of(double seconds) {
  return std::chrono::microseconds(std::llround(1e6 * seconds));
}

}  // namespace

Sender::Sender(const LatencyConfig& config, const std::vector<sources::Frame>& frames)
    : lcm_(config.url),
      scans_(config.scans),
      period_s_(1.0 / config.rate_hz),
      pose_period_s_(1.0 / config.pose_rate_hz) {
  if (frames.size() < 2) throw std::invalid_argument("there are fewer than two frames to send");
  if (!lcm_.good()) throw std::runtime_error("LCM does not start with " + config.url);
  const auto encoding = config.compressed ? kinect_bridge::Encoding::kZlib : kinect_bridge::Encoding::kRaw;
  messages_.reserve(frames.size());
  T_world_sensor_.reserve(frames.size());
  for (const sources::Frame& frame : frames) {
    messages_.push_back(kinect_bridge::to_message(frame.scan, encoding));
    T_world_sensor_.push_back(frame.T_world_sensor);
  }
}

void Sender::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

std::size_t Sender::frame_of(std::size_t i) const {
  const std::size_t turn = 2 * (messages_.size() - 1);
  return std::min(i % turn, turn - i % turn);
}

void Sender::run(const std::stop_token& stop) {
  const auto begin = steady_clock::now();
  const std::int64_t begin_utime = utime_now();
  std::size_t scan = 0;
  // Two poses after the last scan: it is to have one behind it, too.
  const double end_s = period_s_ * static_cast<double>(scans_ - 1) + (2.0 + kPhase) * pose_period_s_;
  for (std::size_t pose = 0; !stop.stop_requested();) {
    const double pose_s = pose_period_s_ * static_cast<double>(pose);
    const double scan_s = period_s_ * static_cast<double>(scan) + kPhase * pose_period_s_;
    const bool is_scan = scan < scans_ && scan_s < pose_s;
    const double due_s = is_scan ? scan_s : pose_s;
    if (due_s > end_s) break;
    const auto due = begin + microseconds_of(due_s);
    std::this_thread::sleep_until(due);
    const std::int64_t utime = begin_utime + microseconds_of(due_s).count();
    if (!is_scan) {
      send_pose(due_s - kPhase * pose_period_s_, utime);
      ++pose;
      continue;
    }
    if (steady_clock::now() - due > microseconds_of(0.5 * period_s_)) ++late_;
    send_scan(scan++, utime);
  }
  is_done_ = true;
}

void Sender::send_scan(std::size_t i, std::int64_t utime) {
  planemap_lcm::depth_scan_t& message = messages_[frame_of(i)];
  message.utime = utime;
  message.seq = static_cast<std::int32_t>(i);
  bytes_.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes_.data(), 0, static_cast<int>(bytes_.size()));
  if (lcm_.publish("PLANEMAP_SCAN", bytes_.data(), static_cast<unsigned>(bytes_.size())) == 0) ++sent_;
}

/// @param after_s  since the first scan
void Sender::send_pose(double after_s, std::int64_t utime) {
  const double place = std::max(0.0, after_s / period_s_);
  const auto i = static_cast<std::size_t>(place);
  const auto pose = kinect_bridge::to_message(
      kinect_bridge::interpolated(T_world_sensor_[frame_of(i)], T_world_sensor_[frame_of(i + 1)],
                                  place - static_cast<double>(i)),
      utime);
  lcm_.publish("POSE", &pose);
}

}  // namespace planemap::benchmark

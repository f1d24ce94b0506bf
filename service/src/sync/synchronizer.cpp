#include "sync/synchronizer.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>

namespace planemap::service {
namespace {

/// Per input; a flood of tiny scans must not grow the queue, either.
constexpr std::size_t kMaxWaitingScans = 1000;

std::size_t bytes_of(const Scan& scan) {
  const auto* depth = std::get_if<DepthScan>(&scan);
  if (depth != nullptr) return sizeof(Scan) + 2 * depth->depth.size();
  const auto& points = std::get<PointScan>(scan);
  return sizeof(Scan) + 4 * (points.xyz_m.size() + points.sigma_m.size());
}

std::string seconds_text(std::int64_t utime) {
  return fmt::format("{}.{:06}", utime / 1000000, utime % 1000000);
}

Eigen::Isometry3d extrinsics_of(const InputConfig& input) {
  const auto& q = input.rotation_wxyz;
  Eigen::Isometry3d T_body_sensor = Eigen::Isometry3d::Identity();
  T_body_sensor.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  T_body_sensor.translation() = Eigen::Map<const Eigen::Vector3d>(input.translation_m.data());
  return T_body_sensor;
}

const char* reason_of(PoseMatch match) {
  switch (match) {
    case PoseMatch::kGap:
      return "pose_gap";
    case PoseMatch::kJump:
      return "pose_jump";
    case PoseMatch::kBefore:
      return "before_poses";
    case PoseMatch::kNoneYet:
    case PoseMatch::kNotYet:
    case PoseMatch::kFound:
      break;
  }
  return "no_pose";
}

}  // namespace

Synchronizer::Synchronizer(const ServiceConfig& config)
    : config_(config.pose), max_waiting_bytes_(static_cast<std::size_t>(config.limits.waiting_bytes)) {
  std::map<std::string, std::size_t> stream_by_channel;
  for (const auto& input : config.inputs) {
    const auto [entry, is_new] = stream_by_channel.emplace(input.pose_channel, streams_.size());
    if (is_new) streams_.emplace_back(config.pose);
    Input state;
    state.pose_channel = input.pose_channel;
    state.stream = entry->second;
    state.T_body_sensor = extrinsics_of(input);
    inputs_.push_back(std::move(state));
  }
}

PoseInsert Synchronizer::add_pose(std::size_t stream, const StampedPose& pose) {
  const PoseInsert result = streams_[stream].insert(pose);
  if (result == PoseInsert::kRestarted) drop_old_run(stream, pose.utime);
  return result;
}

void Synchronizer::drop_old_run(std::size_t stream, std::int64_t restart_utime) {
  const auto history_us = static_cast<std::int64_t>(config_.buffer_s * 1e6);
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (inputs_[i].stream != stream) continue;
    // Scans of the old run stand before those of the new one, which may have been faster than the first new pose.
    while (!inputs_[i].waiting.empty() && inputs_[i].waiting.front().utime > restart_utime + history_us) {
      drop_front(i, "clock_restart",
                 fmt::format("the clock of {} stepped back to {} while the scan at {} waited for its pose",
                             inputs_[i].pose_channel, seconds_text(restart_utime),
                             seconds_text(inputs_[i].waiting.front().utime)),
                 dropped_early_);
    }
  }
}

void Synchronizer::add_scan(std::size_t index, Scan scan, double host_s) {
  Input& input = inputs_[index];
  Waiting waiting;
  waiting.utime = utime_of(scan);
  waiting.since_host_s = host_s;
  waiting.bytes = bytes_of(scan);
  waiting.scan = std::move(scan);
  const auto history_us = static_cast<std::int64_t>(config_.buffer_s * 1e6);
  const bool restarted = waiting.utime < input.newest_utime - history_us;
  input.newest_utime = restarted ? waiting.utime : std::max(input.newest_utime, waiting.utime);
  const std::size_t bytes = waiting.bytes;
  input.waiting.push_back(std::move(waiting));
  waiting_bytes_ += bytes;
  while (input.waiting.size() > kMaxWaitingScans || (waiting_bytes_ > max_waiting_bytes_ && input.waiting.size() > 1)) {
    drop_front(index, "waiting_full",
               fmt::format("{} scans of {} bytes wait for a pose on {}", input.waiting.size(), waiting_bytes_,
                           input.pose_channel),
               dropped_early_);
  }
}

SyncResults Synchronizer::take_ready(double host_s) {
  SyncResults results;
  results.dropped.swap(dropped_early_);
  for (std::size_t i = 0; i < inputs_.size(); ++i) decide(i, host_s, /*at_end=*/false, results);
  return results;
}

SyncResults Synchronizer::finish() {
  SyncResults results;
  results.dropped.swap(dropped_early_);
  for (std::size_t i = 0; i < inputs_.size(); ++i) decide(i, 0.0, /*at_end=*/true, results);
  return results;
}

void Synchronizer::decide(std::size_t index, double host_s, bool at_end, SyncResults& results) {
  Input& input = inputs_[index];
  while (!input.waiting.empty()) {
    const Waiting& first = input.waiting.front();
    const PoseLookup lookup = streams_[input.stream].find(first.utime);
    if (lookup.match == PoseMatch::kFound) {
      results.ready.push_back(RegisteredScan{index, pop_front(input).scan, lookup.T_world_body * input.T_body_sensor});
      continue;
    }
    // What lies between two known poses is decided; anything else may yet be helped by a pose that comes.
    const bool is_final = lookup.match == PoseMatch::kGap || lookup.match == PoseMatch::kJump;
    if (!is_final && !at_end && !has_expired(input, first, host_s)) return;
    drop_front(index, reason_of(lookup.match), describe(input, first.utime, lookup), results.dropped);
  }
}

bool Synchronizer::has_expired(const Input& input, const Waiting& scan, double host_s) const {
  const double by_messages_s = static_cast<double>(input.newest_utime - scan.utime) * 1e-6;
  return by_messages_s > config_.max_wait_s || host_s - scan.since_host_s > config_.max_wait_s;
}

std::string Synchronizer::describe(const Input& input, std::int64_t utime, const PoseLookup& lookup) const {
  const PoseBuffer& buffer = streams_[input.stream];
  const std::string at = seconds_text(utime);
  switch (lookup.match) {
    case PoseMatch::kNoneYet:
      return fmt::format("no pose on {} yet (scan at {})", input.pose_channel, at);
    case PoseMatch::kNotYet:
      return fmt::format("no pose within {} s of scan at {}; last pose on {} at {}", config_.max_wait_s, at,
                         input.pose_channel, seconds_text(buffer.newest_utime()));
    case PoseMatch::kBefore:
      return fmt::format("scan at {} is older than every pose on {} (they begin at {})", at, input.pose_channel,
                         seconds_text(buffer.oldest_utime()));
    case PoseMatch::kGap:
      return fmt::format("the poses on {} around the scan at {} are {:.3f} s apart, more than pose.max_gap_s = {}",
                         input.pose_channel, at, lookup.gap_s, config_.max_gap_s);
    case PoseMatch::kJump:
      return fmt::format("the pose on {} jumped around the scan at {}", input.pose_channel, at);
    case PoseMatch::kFound:
      break;
  }
  return {};
}

void Synchronizer::drop_front(std::size_t index, const char* reason, std::string message,
                              std::vector<UnplacedScan>& dropped) {
  const Waiting scan = pop_front(inputs_[index]);
  dropped.push_back(UnplacedScan{index, scan.utime, reason, std::move(message)});
}

Synchronizer::Waiting Synchronizer::pop_front(Input& input) {
  Waiting scan = std::move(input.waiting.front());
  input.waiting.pop_front();
  waiting_bytes_ -= scan.bytes;
  return scan;
}

}  // namespace planemap::service

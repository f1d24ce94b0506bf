#include "sync/synchronizer.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
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
    : config_(config.pose),
      restart_us_(std::llround(config.pose.restart_s * 1e6)),
      max_waiting_bytes_(static_cast<std::size_t>(config.limits.waiting_bytes)) {
  std::map<std::string, std::size_t> stream_by_channel;
  for (const auto& input : config.inputs) {
    const auto [entry, is_new] = stream_by_channel.emplace(input.pose_channel, streams_.size());
    if (is_new) streams_.push_back(Stream{PoseBuffer(config.pose)});
    Input state;
    state.pose_channel = input.pose_channel;
    state.stream = entry->second;
    state.T_body_sensor = extrinsics_of(input);
    inputs_.push_back(std::move(state));
  }
}

PoseInsert Synchronizer::add_pose(std::size_t stream, const StampedPose& pose) {
  const PoseInsert result = streams_[stream].poses.insert(pose);
  if (result == PoseInsert::kRestarted) drop_old_run(stream, pose.utime);
  return result;
}

void Synchronizer::drop_old_run(std::size_t stream, std::int64_t restart_utime) {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    Input& input = inputs_[i];
    if (input.stream != stream) continue;
    // Scans of the old run stand before those of the new one, which may have been faster than the first new pose.
    while (!input.waiting.empty() && is_of_old_run(input, input.waiting.front(), restart_utime)) {
      drop_front(
          i, "clock_restart",
          fmt::format("the clock of {} stepped back to {} while the scan at {} waited for its pose", input.pose_channel,
                      seconds_text(restart_utime), seconds_text(input.waiting.front().utime)),
          dropped_early_);
    }
    input.posed_run = input.run;
  }
}

bool Synchronizer::is_of_old_run(const Input& input, const Waiting& scan, std::int64_t restart_utime) const {
  const bool scans_restarted_first = input.run > input.posed_run;
  return scans_restarted_first ? scan.run < input.run : scan.utime > restart_utime + restart_us_;
}

void Synchronizer::add_scan(std::size_t index, Scan scan, double host_s) {
  Input& input = inputs_[index];
  Waiting waiting;
  waiting.utime = utime_of(scan);
  waiting.since_host_s = host_s;
  waiting.bytes = bytes_of(scan);
  waiting.scan = std::move(scan);
  if (waiting.utime < input.newest_utime - restart_us_) {
    ++input.run;
    input.run_begin_utime = input.newest_utime = waiting.utime;
    const bool poses_went_before = poses(input.stream).newest_utime() <= waiting.utime + restart_us_;
    if (poses_went_before) input.posed_run = input.run;
  }
  input.newest_utime = std::max(input.newest_utime, waiting.utime);
  waiting.run = input.run;
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
    if (first.run > input.posed_run) {
      if (!at_end && !has_expired(input, first, host_s)) return;
      input.posed_run = first.run;  // the poses' clock goes on: this scan was only late
    }
    const PoseLookup lookup = poses(input.stream).find(first.utime);
    if (lookup.match == PoseMatch::kFound) {
      hand_on(index, lookup, results);
      continue;
    }
    // What lies between two known poses is decided; anything else may yet be helped by a pose that comes.
    const bool is_final = lookup.match == PoseMatch::kGap || lookup.match == PoseMatch::kJump;
    if (!is_final && !at_end && !has_expired(input, first, host_s)) return;
    drop_front(index, reason_of(lookup.match), describe(input, first.utime, lookup), results.dropped);
  }
}

void Synchronizer::hand_on(std::size_t index, const PoseLookup& lookup, SyncResults& results) {
  Input& input = inputs_[index];
  Stream& stream = streams_[input.stream];
  if (config_.resets_map() && lookup.jumps < stream.jumps) {
    return drop_front(index, "old_map",
                      fmt::format("the scan at {} is from before a jump of the pose on {}, where a new map has begun",
                                  seconds_text(input.waiting.front().utime), input.pose_channel),
                      results.dropped);
  }
  // Jumps before the first scan leave nothing behind that would be worth a new map.
  if (config_.resets_map() && lookup.jumps > stream.jumps && !map_is_empty_) ++map_number_;
  stream.jumps = std::max(stream.jumps, lookup.jumps);
  map_is_empty_ = false;
  RegisteredScan ready;
  ready.input = index;
  ready.scan = pop_front(input).scan;
  ready.T_world_sensor = lookup.T_world_body * input.T_body_sensor;
  if (lookup.covariance) ready.pose_covariance = covariance_at_sensor(*lookup.covariance, input.T_body_sensor);
  ready.map_number = map_number_;
  results.ready.push_back(std::move(ready));
}

bool Synchronizer::has_expired(const Input& input, const Waiting& scan, double host_s) const {
  // Times of two runs can't be compared; a scan of the run before has waited at least as long as the new one lasts.
  const std::int64_t from_utime = scan.run == input.run ? scan.utime : input.run_begin_utime;
  const double by_messages_s = static_cast<double>(input.newest_utime - from_utime) * 1e-6;
  return by_messages_s > config_.max_wait_s || host_s - scan.since_host_s > config_.max_wait_s;
}

std::string Synchronizer::describe(const Input& input, std::int64_t utime, const PoseLookup& lookup) const {
  const PoseBuffer& buffer = poses(input.stream);
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

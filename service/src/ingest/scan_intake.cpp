#include "ingest/scan_intake.hpp"

#include <spdlog/fmt/fmt.h>

#include <new>
#include <utility>

#include "codec/pose_codec.hpp"

namespace planemap::service {
namespace {

constexpr double kWarnPeriodS = 5.0;
constexpr std::size_t kMaxUnknownTypes = 64;

ScanFormat format_of(const InputConfig& input) {
  ScanFormat format;
  format.family = input.family;
  format.frame = input.frame;
  format.depth_unit_m = input.depth_unit_m;
  if (const auto& k = input.intrinsics; k.size() >= 4) {
    format.intrinsics = PinholeIntrinsics{0, 0, k[0], k[1], k[2], k[3]};
    if (k.size() == 6) {
      format.intrinsics->width = static_cast<int>(k[4]);
      format.intrinsics->height = static_cast<int>(k[5]);
    }
  }
  if (const auto& d = input.disparity; d.size() == 2) format.disparity = DisparityCalibration{d[0], d[1]};
  return format;
}

}  // namespace

ScanIntake::ScanIntake(const ServiceConfig& config, Counters& counters, Sink sink, Warn warn)
    : counters_(counters),
      sink_(std::move(sink)),
      warn_(std::move(warn)),
      max_scan_bytes_(static_cast<std::size_t>(config.limits.image_bytes)),
      jump_resets_map_(config.pose.resets_map()),
      pose_errors_last_(config.pose.error.correlation_s > 0.0),
      synchronizer_(config),
      repeats_(kWarnPeriodS) {
  for (std::size_t i = 0; i < config.inputs.size(); ++i) {
    const InputConfig& input = config.inputs[i];
    const RateLimiter limiter(input.max_rate_hz, config.pose.restart_s);
    inputs_.push_back(Input{input, format_of(input), PointFilter(input), limiter, std::nullopt});
    scan_channels_.emplace(input.channel, i);
    pose_channels_.emplace(input.pose_channel, synchronizer_.stream_of(i));
    InputFacts facts;
    facts.channel = input.channel;
    facts.pose_channel = input.pose_channel;
    facts_.push_back(std::move(facts));
  }
}

std::vector<std::string> ScanIntake::channels() const {
  std::vector<std::string> channels;
  for (const auto& entry : scan_channels_) channels.push_back(entry.first);
  for (const auto& entry : pose_channels_) channels.push_back(entry.first);
  return channels;
}

bool ScanIntake::on_message(std::string_view channel, std::span<const std::uint8_t> message, double host_s) {
  if (const auto scan = scan_channels_.find(channel); scan != scan_channels_.end()) {
    on_scan(scan->second, message, host_s);
  } else if (const auto pose = pose_channels_.find(channel); pose != pose_channels_.end()) {
    on_pose(pose->second, pose->first, message, host_s);
  } else {
    return false;
  }
  tick(host_s);
  return true;
}

void ScanIntake::tick(double host_s) {
  hand_on(synchronizer_.take_ready(host_s), host_s);
}

void ScanIntake::finish() {
  hand_on(synchronizer_.finish(), 0.0);
}

void ScanIntake::on_scan(std::size_t index, std::span<const std::uint8_t> message, double host_s) {
  counters_.scan_received();
  try {
    take_scan(index, message, host_s);
  } catch (const std::bad_alloc&) {
    reject_scan(index, Rejection{"no_memory", fmt::format("no memory for a scan of {} bytes", message.size())}, host_s);
  }
}

void ScanIntake::take_scan(std::size_t index, std::span<const std::uint8_t> message, double host_s) {
  auto decoded = decode_scan(message, max_scan_bytes_, inputs_[index].format);
  if (!decoded) return reject_scan(index, decoded.error(), host_s);
  {
    const std::lock_guard lock(facts_mutex_);
    ++facts_[index].scans;
    facts_[index].last_scan_host_s = host_s;
  }
  if (!is_wanted(index, *decoded, host_s)) return;
  count_filtered(inputs_[index], decoded->scan);
  synchronizer_.add_scan(index, std::move(decoded->scan), host_s);
}

bool ScanIntake::is_wanted(std::size_t index, const DecodedScan& decoded, double host_s) {
  Input& input = inputs_[index];
  const std::int64_t utime = utime_of(decoded.scan);
  const auto before = std::exchange(input.last_scan, std::pair(utime, decoded.seq));
  if (before && before->first == utime && before->second == decoded.seq) {
    leave_out(index, "duplicate", fmt::format("the same scan comes on {} again and again", input.config.channel),
              host_s);
    return false;
  }
  if (before && utime > before->first && decoded.seq > before->second && before->second >= 0) {
    const std::int64_t lost = std::int64_t{decoded.seq} - before->second - 1;
    if (lost > 0) counters_.add("scans_lost_before_arrival." + input.config.name, lost);
  }
  if (!input.limiter.passes(utime)) {
    leave_out(
        index, "rate_limit",
        fmt::format("max_rate_hz = {} lets no scan on {} pass yet", input.config.max_rate_hz, input.config.channel),
        host_s);
    return false;
  }
  return true;
}

void ScanIntake::leave_out(std::size_t index, const char* reason, std::string message, double host_s) {
  counters_.scan_dropped(reason);
  const std::lock_guard lock(facts_mutex_);
  facts_[index].last_left_out = std::move(message);
  facts_[index].last_left_out_host_s = host_s;
}

void ScanIntake::count_filtered(Input& input, Scan& scan) {
  const FilteredPoints filtered = input.filter.apply(scan);
  if (filtered.out_of_range > 0)
    counters_.add("points_out_of_input_range", static_cast<std::int64_t>(filtered.out_of_range));
  if (filtered.own_body > 0) counters_.add("points_on_own_body", static_cast<std::int64_t>(filtered.own_body));
}

void ScanIntake::reject_scan(std::size_t index, const Rejection& rejection, double host_s) {
  const std::string& channel = inputs_[index].config.channel;
  counters_.scan_rejected(rejection.reason);
  warn_rejection(channel, rejection, host_s);
  const std::lock_guard lock(facts_mutex_);
  facts_[index].last_problem = last_problem_ = fmt::format("{}: {}", channel, rejection.message);
  facts_[index].last_problem_host_s = host_s;
}

void ScanIntake::on_pose(std::size_t stream, const std::string& channel, std::span<const std::uint8_t> message,
                         double host_s) {
  counters_.add("poses.received");
  const auto pose = decode_pose(message);
  if (pose) {
    if (pose->covariance) note_covariance(channel);
    return note_pose(stream, channel, synchronizer_.add_pose(stream, *pose), host_s);
  }
  counters_.add("poses.rejected." + pose.error().reason);
  warn_rejection(channel, pose.error(), host_s);
  const std::lock_guard lock(facts_mutex_);
  last_problem_ = fmt::format("{}: {}", channel, pose.error().message);
  for (std::size_t i = 0; i < facts_.size(); ++i) {
    if (synchronizer_.stream_of(i) != stream) continue;
    facts_[i].last_pose_problem = last_problem_;
    facts_[i].last_pose_problem_host_s = host_s;
  }
}

void ScanIntake::note_covariance(const std::string& channel) {
  counters_.add("poses.with_covariance");
  if (std::exchange(said_that_errors_are_independent_, true) || pose_errors_last_) return;
  warn_(fmt::format(
      "the poses on {} state their covariance, but not how long an error lasts: with pose.correlation_s = 0 each pose "
      "errs on its own, and the planes are taken for surer than they are",
      channel));
}

void ScanIntake::note_pose(std::size_t stream, const std::string& channel, PoseInsert result, double host_s) {
  switch (result) {
    case PoseInsert::kAppended:
      break;
    case PoseInsert::kOutOfOrder:
      counters_.add("poses.out_of_order");
      break;
    case PoseInsert::kDuplicate:
      counters_.add("poses.duplicate");
      break;
    case PoseInsert::kTooOld:
      counters_.add("poses.too_old");
      break;
    case PoseInsert::kJumped:
      counters_.add("poses.jumps");
      warn_once_in_a_while("jump " + channel,
                           fmt::format("the pose on {} jumped; {}", channel,
                                       jump_resets_map_ ? "a new map begins with the scans after it"
                                                        : "the map goes on, and may hold things twice"),
                           host_s);
      break;
    case PoseInsert::kRestarted:
      counters_.add("poses.restarts");
      warn_once_in_a_while(
          "restart " + channel,
          fmt::format("the clock of {} stepped back: its poses were forgotten, the map goes on", channel), host_s);
      break;
  }
  const std::lock_guard lock(facts_mutex_);
  for (std::size_t i = 0; i < facts_.size(); ++i) {
    if (synchronizer_.stream_of(i) != stream) continue;
    ++facts_[i].poses;
    facts_[i].last_pose_host_s = host_s;
  }
}

void ScanIntake::hand_on(SyncResults results, double host_s) {
  for (const auto& scan : results.dropped) {
    counters_.scan_dropped(scan.reason);
    const std::lock_guard lock(facts_mutex_);
    facts_[scan.input].last_problem = last_problem_ = scan.message;
    facts_[scan.input].last_problem_host_s = host_s;
  }
  {
    const std::lock_guard lock(facts_mutex_);
    for (std::size_t i = 0; i < facts_.size(); ++i)
      facts_[i].waiting = static_cast<std::int64_t>(synchronizer_.waiting(i));
    for (const auto& scan : results.ready) {
      ++facts_[scan.input].handed_on;
      facts_[scan.input].last_handed_on_host_s = host_s;
    }
  }
  for (auto& scan : results.ready) sink_(std::move(scan));
}

void ScanIntake::warn_rejection(const std::string& channel, const Rejection& rejection, double host_s) {
  if (rejection.reason == "unknown_type" || rejection.reason == "wrong_channel") {
    // A wrong program on the channel sends the same type for hours: said once for each type.
    const std::string text =
        fmt::format("channel {}: {}; such messages are counted, not used", channel, rejection.message);
    if (unknown_types_.size() < kMaxUnknownTypes && unknown_types_.insert(text).second) warn_(text);
    return;
  }
  warn_once_in_a_while(rejection.reason + " " + channel, fmt::format("channel {}: {}", channel, rejection.message),
                       host_s);
}

void ScanIntake::warn_once_in_a_while(const std::string& kind, const std::string& text, double host_s) {
  const int count = repeats_.pass(kind, host_s);
  if (count > 0) warn_(text + repeats_text(count));
}

std::vector<InputFacts> ScanIntake::facts() const {
  const std::lock_guard lock(facts_mutex_);
  return facts_;
}

std::string ScanIntake::last_problem() const {
  const std::lock_guard lock(facts_mutex_);
  return last_problem_;
}

}  // namespace planemap::service

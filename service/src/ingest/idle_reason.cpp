#include "ingest/idle_reason.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <vector>

namespace planemap::service {
namespace {

bool is_recent(double host_s, double now_host_s) {
  return now_host_s - host_s < kIdleAfterS;
}

bool is_recent(const std::string& text, double host_s, double now_host_s) {
  return !text.empty() && is_recent(host_s, now_host_s);
}

bool reaches_the_mapper(const InputFacts& input, double now_host_s) {
  return input.handed_on > 0 && is_recent(input.last_handed_on_host_s, now_host_s);
}

/// Why scans that reached the mapper are not mapped.
std::vector<std::string> mapper_reasons(const MapperFacts& mapper, double now_host_s) {
  std::vector<std::string> reasons;
  if (is_recent(mapper.last_error, mapper.last_error_host_s, now_host_s)) reasons.push_back(mapper.last_error);
  const bool hangs = mapper.busy_since_host_s && !is_recent(*mapper.busy_since_host_s, now_host_s);
  if (hangs) {
    reasons.push_back(
        fmt::format("the mapper has been busy with one scan for {:.0f} s", now_host_s - *mapper.busy_since_host_s));
  }
  if (mapper.dropped_from_full_queue > 0 && is_recent(mapper.last_dropped_host_s, now_host_s)) {
    reasons.push_back(
        fmt::format("the mapper cannot keep up: {} scans were dropped from its full queue (queue.scans = {})",
                    mapper.dropped_from_full_queue, mapper.queue_capacity));
  } else if (mapper.queued > 0) {
    reasons.push_back(fmt::format("{} scans wait for the mapper", mapper.queued));
  }
  return reasons;
}

/// Why no scan of the input reaches the mapper.
std::string input_reason(const InputFacts& input, double now_host_s) {
  const bool scans_come = input.scans > 0 && is_recent(input.last_scan_host_s, now_host_s);
  // What came and could not be used says more than that nothing came.
  if (!scans_come && is_recent(input.last_problem, input.last_problem_host_s, now_host_s)) return input.last_problem;
  if (input.scans == 0) return fmt::format("no scan on {} yet", input.channel);
  if (!scans_come) {
    return fmt::format("no scan on {} for {:.0f} s", input.channel, now_host_s - input.last_scan_host_s);
  }
  if (is_recent(input.last_pose_problem, input.last_pose_problem_host_s, now_host_s) &&
      !is_recent(input.last_pose_host_s, now_host_s)) {
    return input.last_pose_problem;
  }
  if (input.poses == 0) return fmt::format("no pose on {} yet", input.pose_channel);
  if (is_recent(input.last_problem, input.last_problem_host_s, now_host_s)) return input.last_problem;
  if (input.waiting > 0) {
    return fmt::format("{} scans on {} wait for a pose on {}", input.waiting, input.channel, input.pose_channel);
  }
  if (is_recent(input.last_left_out, input.last_left_out_host_s, now_host_s)) return input.last_left_out;
  return fmt::format("the scans on {} are on their way to the mapper", input.channel);
}

}  // namespace

std::string idle_reason(std::span<const InputFacts> inputs, const MapperFacts& mapper, double now_host_s) {
  if (mapper.is_paused) return "mapping is paused: scans are dropped until it is resumed";
  // What was mapped before a reset is not in the map.
  const bool is_anew = mapper.reset_host_s && (mapper.mapped == 0 || mapper.last_mapped_host_s <= *mapper.reset_host_s);
  if (!is_anew && mapper.mapped > 0 && is_recent(mapper.last_mapped_host_s, now_host_s)) return {};
  std::vector<std::string> reasons = mapper_reasons(mapper, now_host_s);
  const bool mapper_says_why = !reasons.empty();
  for (const auto& input : inputs) {
    if (mapper_says_why && reaches_the_mapper(input, now_host_s)) continue;
    const bool is_silent = is_anew && input.scans > 0 && input.last_scan_host_s <= *mapper.reset_host_s;
    std::string reason = is_silent ? fmt::format("no scan on {} since the map was reset {:.0f} s ago", input.channel,
                                                 now_host_s - *mapper.reset_host_s)
                                   : input_reason(input, now_host_s);
    if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end()) reasons.push_back(std::move(reason));
  }
  return fmt::format("{}", fmt::join(reasons, "; "));
}

}  // namespace planemap::service

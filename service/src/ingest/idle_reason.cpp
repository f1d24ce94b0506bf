#include "ingest/idle_reason.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <vector>

namespace planemap::service {
namespace {

bool is_recent(const std::string& text, double host_s, double now_host_s) {
  return !text.empty() && now_host_s - host_s < kIdleAfterS;
}

std::string reason_of(const InputFacts& input, double now_host_s) {
  const bool scans_come = input.scans > 0 && now_host_s - input.last_scan_host_s < kIdleAfterS;
  // What came and could not be used says more than that nothing came.
  if (!scans_come && is_recent(input.last_problem, input.last_problem_host_s, now_host_s)) return input.last_problem;
  if (input.scans == 0) return fmt::format("no scan on {} yet", input.channel);
  if (!scans_come) {
    return fmt::format("no scan on {} for {:.0f} s", input.channel, now_host_s - input.last_scan_host_s);
  }
  if (is_recent(input.last_pose_problem, input.last_pose_problem_host_s, now_host_s) &&
      now_host_s - input.last_pose_host_s >= kIdleAfterS) {
    return input.last_pose_problem;
  }
  if (input.poses == 0) return fmt::format("no pose on {} yet", input.pose_channel);
  if (!input.last_problem.empty()) return input.last_problem;
  return fmt::format("{} scans on {} wait for a pose on {}", input.waiting, input.channel, input.pose_channel);
}

}  // namespace

std::string idle_reason(std::span<const InputFacts> inputs, const MapperFacts& mapper, double now_host_s) {
  if (mapper.mapped > 0 && now_host_s - mapper.last_mapped_host_s < kIdleAfterS) return {};
  std::vector<std::string> reasons;
  for (const auto& input : inputs) {
    std::string reason = reason_of(input, now_host_s);
    if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end()) reasons.push_back(std::move(reason));
  }
  return fmt::format("{}", fmt::join(reasons, "; "));
}

}  // namespace planemap::service

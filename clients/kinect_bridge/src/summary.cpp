#include "summary.hpp"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

namespace planemap::kinect_bridge {

std::string summary_text(const Summary& summary, const Options& options) {
  const FeedReport& report = summary.report;
  std::string text = fmt::format("{} frames and {} poses, {:.1f} MB, in {:.1f} s to {}\n", report.frames, report.poses,
                                 static_cast<double>(report.bytes) / 1e6, summary.seconds,
                                 options.log_path.empty() ? options.lcm_url : options.log_path);
  for (const auto& entry : summary.skipped) text += fmt::format("skipped {} frames: {}\n", entry.second, entry.first);
  if (report.late > 0)
    text += fmt::format("{} frames were late: this machine can't keep up with the rate\n", report.late);
  const std::string settings = settings_for(options.feed.format.scan, report.intrinsics);
  if (report.frames > 0 && !settings.empty()) text += "such scans need: planemapd " + settings + "\n";
  if (report.unsent > 0) text += fmt::format("{} messages could not be sent\n", report.unsent);
  return text;
}

std::string summary_json(const Summary& summary, const Options& options) {
  const FeedReport& report = summary.report;
  nlohmann::ordered_json json = {{"frames", report.frames},        {"poses", report.poses},
                                 {"bytes", report.bytes},          {"seconds", summary.seconds},
                                 {"lateFrames", report.late},      {"unsentMessages", report.unsent},
                                 {"skipped", summary.skipped},     {"firstUtime", report.first_utime},
                                 {"lastUtime", report.last_utime}, {"stopped", report.stopped}};
  const PinholeIntrinsics& camera = report.intrinsics;
  if (report.frames > 0) json["intrinsics"] = {camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height};
  if (options.log_path.empty()) {
    json["lcmUrl"] = options.lcm_url;
  } else {
    json["log"] = options.log_path;
  }
  if (!options.truth_path.empty()) json["truth"] = options.truth_path;
  return json.dump(2) + "\n";
}

}  // namespace planemap::kinect_bridge

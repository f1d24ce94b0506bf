#include "soak/soak_report.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "soak/trend.hpp"

namespace planemap::system_test {

namespace {

constexpr double kMb = 1e6;
constexpr double kResidentMbPerHour = 4.0;
constexpr double kHeapMbPerHour = 1.0;

std::vector<Reading> readings(const SoakConfig& config, const SoakResult& result, double SoakSample::*member) {
  std::vector<Reading> readings;
  for (const SoakSample& sample : result.samples) {
    if (sample.at_s >= 60.0 * config.warm_up_minutes) readings.push_back({sample.at_s, sample.*member});
  }
  return readings;
}

double mb_per_hour(const std::vector<Reading>& readings) {
  return 3600.0 * slope_per_s(readings) / kMb;
}

double hours(const SoakConfig& config) {
  return (config.minutes - config.warm_up_minutes) / 60.0;
}

std::int64_t counter(const SoakResult& result, const std::string& name) {
  const auto found = result.counters.find(name);
  return found == result.counters.end() ? 0 : found->second;
}

}  // namespace

std::vector<SoakBound> soak_bounds(const SoakConfig& config, const SoakResult& result, const SoakSlack& slack) {
  const double slack_mb_per_hour = slack.memory_mb / hours(config);
  return {{"residentMbPerHour", "memory of the process, MB an hour",
           mb_per_hour(readings(config, result, &SoakSample::resident_b)), kResidentMbPerHour + slack_mb_per_hour},
          {"heapMbPerHour", "memory that it holds, MB an hour",
           mb_per_hour(readings(config, result, &SoakSample::heap_b)), kHeapMbPerHour + slack_mb_per_hour},
          {"notMapped", "scans that were sent and not mapped",
           static_cast<double>(result.sent - counter(result, "scans.mapped")),
           slack.lost_share * static_cast<double>(result.sent)},
          {"complaints", "answers that clients complain of", static_cast<double>(result.complaints.size()), 0.0},
          {"exitCode", "exit code of the daemon", static_cast<double>(std::abs(result.daemon_exit_code)), 0.0}};
}

std::string soak_table(const SoakConfig& config, const SoakResult& result, const SoakSlack& slack) {
  const SoakSample& last = result.samples.back();
  std::string text = fmt::format(
      "{:.1f} minutes, the first {:.1f} to warm up; {} scans sent, {} cells, {:.1f} MB\nclients:", config.minutes,
      config.warm_up_minutes, result.sent, last.cells, last.resident_b / kMb);
  for (const auto& [kind, count] : result.visits) text += fmt::format(" {} {}", count, kind);
  text += "\n\n";
  for (const SoakBound& bound : soak_bounds(config, result, slack)) {
    text += fmt::format("{:<40} {:9.2f}  <= {:.2f}  {}\n", bound.words, bound.value, bound.most,
                        bound.held() ? "held" : "missed");
  }
  for (const std::string& complaint : result.complaints) text += "  " + complaint + "\n";
  return text;
}

std::string soak_json(const SoakConfig& config, const SoakResult& result, const SoakSlack& slack) {
  nlohmann::ordered_json report;
  report["minutes"] = config.minutes;
  report["warmUpMinutes"] = config.warm_up_minutes;
  for (const SoakBound& bound : soak_bounds(config, result, slack)) {
    report["bounds"][bound.name] = {{"value", bound.value}, {"most", bound.most}, {"held", bound.held()}};
  }
  report["scansSent"] = result.sent;
  report["visits"] = result.visits;
  report["complaints"] = result.complaints;
  report["counters"] = result.counters;
  for (const SoakSample& sample : result.samples) {
    report["samples"].push_back({sample.at_s, sample.resident_b, sample.heap_b, sample.cells, sample.scans});
  }
  report["sampleFields"] = {"seconds", "residentBytes", "heapBytes", "cells", "scans"};
  return report.dump();
}

}  // namespace planemap::system_test

#include "build/build_summary.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "plane_table.hpp"

namespace planemap::cli {
namespace {

using Json = nlohmann::ordered_json;
using Counts = std::map<std::string, std::int64_t>;

/// Counters that begin with a prefix, without it.
Counts counters_below(const BuildResult& result, const std::string& prefix) {
  Counts counts;
  for (const auto& [name, value] : result.counters) {
    if (name.rfind(prefix, 0) == 0 && value != 0) counts[name.substr(prefix.size())] = value;
  }
  return counts;
}

Json json_of(const Spread& spread) {
  return {{"p50", spread.p50}, {"p95", spread.p95}, {"max", spread.max}};
}

bool ran(const std::vector<double>& stage_ms) {
  return std::any_of(stage_ms.begin(), stage_ms.end(), [](double ms) { return ms > 0.0; });
}

std::string counts_text(const Counts& counts) {
  std::string text;
  for (const auto& [name, value] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", value, name);
  return text;
}

std::string spread_line(const char* name, const std::vector<double>& ms) {
  const Spread spread = spread_of(ms);
  return fmt::format("  {:<14}{:>10.2f}{:>10.2f}{:>10.2f}\n", name, spread.p50, spread.p95, spread.max);
}

std::string times_text(const service::StageTimes& times) {
  std::string text = fmt::format("{:<16}{:>10}{:>10}{:>10}\n", "ms per scan", "p50", "p95", "max");
  text += spread_line("all", times.scan_ms);
  for (std::size_t i = 0; i < kStageCount; ++i) {
    if (ran(times.stage_ms[i])) text += spread_line(name_of(static_cast<Stage>(i)), times.stage_ms[i]);
  }
  return text;
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto rank = [&](double share) {
    const auto nearest = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::max<std::size_t>(nearest, 1) - 1];
  };
  return {rank(0.5), rank(0.95), values.back()};
}

std::string summary_text(const BuildResult& result, const ExportMap& map) {
  const PointCounts& points = result.points;
  std::string text =
      fmt::format("scans mapped: {} in {:.1f} s; points: {:.2f} million, mapped {:.2f} million\n", result.mapped(),
                  result.seconds, static_cast<double>(points.total) * 1e-6, static_cast<double>(points.mapped) * 1e-6);
  Counts skipped;
  for (const auto& [reason, count] : result.skipped) skipped[reason] = static_cast<std::int64_t>(count);
  const auto list = [&](const char* what, const Counts& counts) {
    if (!counts.empty()) text += fmt::format("{}: {}\n", what, counts_text(counts));
  };
  list("skipped", skipped);
  list("dropped", counters_below(result, "scans.dropped."));
  list("rejected", counters_below(result, "scans.rejected."));
  if (const auto resets = counters_below(result, "map.resets"); !resets.empty()) {
    text += fmt::format("the pose jumped, and a new map began {} times: what follows is the last one\n",
                        resets.begin()->second);
  }
  if (result.gaps > 0)
    text += fmt::format("damaged stretches of the log: {}, {} bytes\n", result.gaps, result.gap_bytes);
  text += '\n' + times_text(result.times) + '\n';
  text += fmt::format("map {}, revision {}, frame {}; planes: {}, cells: {}\n", map.epoch, map.revision, map.frame,
                      map.planes.size(), result.snapshot->cell_count());
  if (const auto worn = counters_below(result, "cells.worn"); !worn.empty()) {
    text += fmt::format("cells worn away, since later scans see through them: {}\n", worn.begin()->second);
  }
  return text + plane_table(map);
}

std::string summary_json(const BuildResult& result, const ExportMap& map, const std::vector<std::string>& exported) {
  const PointCounts& points = result.points;
  Json json;
  json["scans"] = result.mapped();
  json["points"] = {{"total", points.total},
                    {"mapped", points.mapped},
                    {"noReturn", points.no_return},
                    {"outOfRange", points.out_of_range},
                    {"invalid", points.invalid}};
  json["skipped"] = result.skipped;
  json["dropped"] = counters_below(result, "scans.dropped.");
  json["rejected"] = counters_below(result, "scans.rejected.");
  json["logGaps"] = {{"count", result.gaps}, {"bytes", result.gap_bytes}};
  json["cells"] = result.snapshot->cell_count();
  json["denseCells"] = map.cells.size();
  json["planes"] = map.planes.size();
  json["seconds"] = result.seconds;
  Json times = json_of(spread_of(result.times.scan_ms));
  times["stages"] = Json::object();
  for (std::size_t i = 0; i < kStageCount; ++i) {
    if (!ran(result.times.stage_ms[i])) continue;
    times["stages"][name_of(static_cast<Stage>(i))] = json_of(spread_of(result.times.stage_ms[i]));
  }
  json["msPerScan"] = std::move(times);
  json["frame"] = map.frame;
  json["epoch"] = map.epoch;
  json["revision"] = map.revision;
  json["counters"] = result.counters;
  json["exports"] = exported;
  return json.dump() + '\n';
}

std::string nothing_mapped(const BuildResult& result) {
  std::string text = "no scan was mapped";
  if (!result.last_problem.empty()) return text + ": " + result.last_problem;
  if (!result.skipped.empty()) {
    Counts skipped;
    for (const auto& [reason, count] : result.skipped) skipped[reason] = static_cast<std::int64_t>(count);
    return text + "; skipped: " + counts_text(skipped);
  }
  if (!result.channels.empty()) {
    text += "; none of the inputs' channels carried one. Channels of the log:";
    for (const auto& [channel, count] : result.channels) text += fmt::format(" {} ({})", channel, count);
  }
  return text;
}

}  // namespace planemap::cli

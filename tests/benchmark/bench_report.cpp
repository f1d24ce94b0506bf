#include "bench_report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/machine.hpp"

namespace planemap::benchmark {

namespace {

constexpr const char* kReference = "reference";
constexpr const char* kVoxelGrid = "pclVoxelGrid";

constexpr const char* kWhole = "planemap";
constexpr const char* kAssign = "planemap.assign";
constexpr const char* kSse4 = "planemapSse4";

}  // namespace

Versions library_versions() {
  return {PLANEMAP_VERSION, PLANEMAP_PCL_VERSION, PLANEMAP_OCTOMAP_VERSION};
}

void BenchReport::add(const PartTimes& times) {
  for (const PartTime& time : times) {
    auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.name == time.name; });
    if (part == parts_.end()) part = parts_.insert(parts_.end(), Part{time.name, {}, {}});
    part->ms.push_back(time.ms);
    part->own_ms.push_back(time.own_ms);
  }
}

std::vector<std::string> BenchReport::parts() const {
  std::vector<std::string> names;
  names.reserve(parts_.size());
  for (const Part& part : parts_) names.push_back(part.name);
  return names;
}

const BenchReport::Part* BenchReport::find(const std::string& name) const {
  const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.name == name; });
  return part == parts_.end() ? nullptr : &*part;
}

const BenchReport::Part& BenchReport::part(const std::string& name) const {
  const Part* found = find(name);
  if (found == nullptr) throw std::invalid_argument("no times of " + name);
  return *found;
}

std::vector<BenchReport::Bound> BenchReport::bounds() const {
  std::vector<Bound> bounds;
  const auto add = [&](const char* name, const char* words, const char* part, const char* other, double most,
                       double aim) {
    if (find(part) == nullptr || find(other) == nullptr) return;
    bounds.push_back(
        {name, words, median_ms(part) / median_ms(other), own_median_ms(part) / own_median_ms(other), most, aim});
  };
  add("wholeToVoxelGrid", "whole pipeline / PCL VoxelGrid", kWhole, kVoxelGrid, 0.8, 0.4);
  add("wholeToReference", "whole pipeline / reference loop", kWhole, kReference, 6.0, 3.0);
  add("assignToReference", "assignment and sums / reference loop", kAssign, kReference, 3.5, 2.0);
  bounds.push_back({"p95ToMedian", "p95 / median of the whole pipeline", p95_ms(kWhole) / median_ms(kWhole),
                    quantile(part(kWhole).own_ms, 0.95) / own_median_ms(kWhole), 1.6, 1.6});
  add("sse4ToBest", "whole pipeline: SSE4 / the target at hand", kSse4, kWhole, 2.0, 2.0);
  return bounds;
}

std::string BenchReport::table() const {
  std::string text = "                              median    p95    own  / reference  / VoxelGrid\n";
  const auto ratio = [&](const Part& part, const char* other) {
    std::array<char, 32> cell{"            -"};
    if (find(other) != nullptr) {
      std::snprintf(cell.data(), cell.size(), "%13.2f", median(part.own_ms) / own_median_ms(other));
    }
    return std::string(cell.data());
  };
  for (const Part& part : parts_) {
    std::array<char, 96> row;
    std::snprintf(row.data(), row.size(), "%-26s %6.2f ms %6.2f %6.2f", part.name.c_str(), median(part.ms),
                  p95_ms(part.name), median(part.own_ms));
    text += row.data() + ratio(part, kReference) + ratio(part, kVoxelGrid) + "\n";
  }
  return text + "own: the thread's own time, and the ratios are of that.\n";
}

std::string BenchReport::bounds_table() const {
  std::string text = "                                            ratio     own   bound     aim\n";
  for (const Bound& bound : bounds()) {
    std::array<char, 128> row;
    std::snprintf(row.data(), row.size(), "%-42s %6.2f  %6.2f  <= %4.2f  <= %4.2f%s\n", bound.words, bound.ratio,
                  bound.own_ratio, bound.most, bound.aim, bound.own_ratio > bound.most ? "  missed" : "");
    text += row.data();
  }
  return text;
}

std::string BenchReport::json(std::size_t frames, std::size_t points) const {
  nlohmann::ordered_json report;
  for (const Part& part : parts_) report["medianMs"][part.name] = median_ms(part.name);
  for (const Part& part : parts_) report["p95Ms"][part.name] = p95_ms(part.name);
  for (const Part& part : parts_) report["ownMedianMs"][part.name] = own_median_ms(part.name);
  for (const Bound& bound : bounds()) report["ratios"][bound.name] = bound.ratio;
  for (const Bound& bound : bounds()) report["ownRatios"][bound.name] = bound.own_ratio;
  report["frames"] = frames;
  report["pointsPerFrame"] = points;
  report["machine"] = json_of(this_machine());
  const Versions versions = library_versions();
  report["versions"] = {{"planemap", versions.planemap}, {"pcl", versions.pcl}, {"octomap", versions.octomap}};
  return report.dump(2);
}

}  // namespace planemap::benchmark

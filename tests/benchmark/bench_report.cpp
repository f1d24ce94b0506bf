#include "bench_report.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace planemap::benchmark {

namespace {

constexpr const char* kReference = "reference";
constexpr const char* kVoxelGrid = "pclVoxelGrid";

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

Machine this_machine() {
  return {cpu_name(), "GCC " __VERSION__, PLANEMAP_BUILD_FLAGS, PLANEMAP_PCL_VERSION, PLANEMAP_OCTOMAP_VERSION};
}

void BenchReport::add(const PartTimes& times) {
  for (const auto& [name, ms] : times) {
    auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.name == name; });
    if (part == parts_.end()) part = parts_.insert(parts_.end(), Part{name, {}});
    part->ms.push_back(ms);
  }
}

const BenchReport::Part* BenchReport::find(const std::string& name) const {
  const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.name == name; });
  return part == parts_.end() ? nullptr : &*part;
}

double BenchReport::quantile_ms(const std::string& part, double q) const {
  const Part* found = find(part);
  if (found == nullptr) throw std::invalid_argument("no times of " + part);
  std::vector<double> ms = found->ms;
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(ms.size() - 1));
  std::nth_element(ms.begin(), ms.begin() + at, ms.end());
  return ms[static_cast<std::size_t>(at)];
}

std::string BenchReport::table() const {
  std::string text = "                            median    p95   / reference  / VoxelGrid\n";
  const auto ratio = [&](double ms, const char* other) {
    char cell[32] = "            -";
    if (find(other) != nullptr) std::snprintf(cell, sizeof cell, "%13.2f", ms / median_ms(other));
    return std::string(cell);
  };
  for (const Part& part : parts_) {
    char row[96];
    const double ms = median_ms(part.name);
    std::snprintf(row, sizeof row, "%-24s %6.2f ms %6.2f", part.name.c_str(), ms, p95_ms(part.name));
    text += row + ratio(ms, kReference) + ratio(ms, kVoxelGrid) + "\n";
  }
  return text;
}

std::string BenchReport::json(std::size_t frames, std::size_t points) const {
  nlohmann::ordered_json report;
  for (const Part& part : parts_) report["medianMs"][part.name] = median_ms(part.name);
  for (const Part& part : parts_) report["p95Ms"][part.name] = p95_ms(part.name);
  report["frames"] = frames;
  report["pointsPerFrame"] = points;
  const Machine machine = this_machine();
  report["machine"] = {{"cpu", machine.cpu},
                       {"compiler", machine.compiler},
                       {"flags", machine.flags},
                       {"pcl", machine.pcl},
                       {"octomap", machine.octomap}};
  return report.dump(2);
}

}  // namespace planemap::benchmark

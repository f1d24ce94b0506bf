#include "common/machine.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

namespace planemap::benchmark {

namespace {

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
  double load = 0.0;
  if (getloadavg(&load, 1) != 1) load = 0.0;
  return {cpu_name(),         std::thread::hardware_concurrency(), load, "GCC " __VERSION__, PLANEMAP_BUILD_FLAGS,
          PLANEMAP_BUILD_TYPE};
}

std::string text_of(const Machine& machine) {
  std::array<char, 64> load;
  std::snprintf(load.data(), load.size(), "%u cores, load %.1f", machine.cores, machine.load);
  return machine.cpu + ", " + load.data() + "; " + machine.compiler + " " + machine.flags + " (" + machine.build + ")";
}

nlohmann::ordered_json json_of(const Machine& machine) {
  return {{"cpu", machine.cpu},           {"cores", machine.cores}, {"load", machine.load},
          {"compiler", machine.compiler}, {"flags", machine.flags}, {"buildType", machine.build}};
}

}  // namespace planemap::benchmark

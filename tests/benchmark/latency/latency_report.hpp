#pragma once

#include <string>
#include <vector>

#include "latency/latency_run.hpp"

namespace planemap::benchmark {

/// What the delta of a scan must come within, milliseconds, and what no scan may get lost by.
struct LatencyBound {
  const char* name;   ///< for scripts
  const char* words;  ///< for people
  double value = 0.0;
  double most = 0.0;
  double aim = 0.0;
  bool held() const { return value <= most; }
};

/// Bounds: p99 and the scans that were not mapped. Throws std::invalid_argument if no scan is in a delta.
std::vector<LatencyBound> latency_bounds(const LatencyResult& result);
/// For people.
std::string latency_table(const LatencyConfig& config, const LatencyResult& result);
/// The same as one object.
std::string latency_json(const LatencyConfig& config, const LatencyResult& result);

}  // namespace planemap::benchmark

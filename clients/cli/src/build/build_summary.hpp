#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "build/build_run.hpp"
#include "export/export_map.hpp"

namespace planemap::cli {

/// Milliseconds: median, 95th percentile (nearest rank) and maximum; zeros for no values.
struct Spread {
  double p50 = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};
Spread spread_of(std::vector<double> values);

/// What was built, for people.
std::string summary_text(const BuildResult& result, const ExportMap& map);

/// The same as one JSON object.
std::string summary_json(const BuildResult& result, const ExportMap& map, const std::vector<std::string>& exported);

/// Why no scan at all was mapped, in a sentence.
std::string nothing_mapped(const BuildResult& result);

}  // namespace planemap::cli

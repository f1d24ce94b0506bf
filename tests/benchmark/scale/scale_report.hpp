#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "scale/scale_run.hpp"

namespace planemap::benchmark {

/// The large map beside its twin of some 100 m2, by the thread's own time: the mean over the windows from 9,000 m2 on;
/// where the map is smaller, of the last window.
struct ScaleRatio {
  double ratio = 0.0;    ///< 0: there was no twin
  double area_m2 = 0.0;  ///< of the map, in the end
};
ScaleRatio scale_ratio(std::span<const ScaleWindow> windows);

std::string scale_table_head();
std::string scale_table_row(const ScaleWindow& window);
/// {"windows": [{"scans", "areaM2", ...}], "ratio": ..., "machine": {...}}
std::string scale_json(std::span<const ScaleWindow> windows);
/// Time of a scan, memory and the cost of snapshots against the size of the map. Throws std::runtime_error where the
/// file can't be written.
void draw_scale(std::span<const ScaleWindow> windows, const std::filesystem::path& file);

}  // namespace planemap::benchmark

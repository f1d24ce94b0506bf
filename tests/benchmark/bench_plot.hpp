#pragma once

#include <filesystem>

#include "bench_report.hpp"

namespace planemap::benchmark {

/// A bar for each program, planemap's in its stages: the thread's own time, medians. Throws std::runtime_error where
/// the file can't be written.
/// @param subtitle  what was measured on
void draw_bench(const BenchReport& report, const std::string& subtitle, const std::filesystem::path& file);

}  // namespace planemap::benchmark

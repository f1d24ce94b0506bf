#pragma once

#include <cstddef>
#include <planemap/config.hpp>
#include <planemap/sources/frame_source.hpp>
#include <vector>

#include "contestant.hpp"

namespace planemap::benchmark {

/// Reads up to so many frames and prepares them for all contestants.
std::vector<BenchFrame> read_frames(sources::FrameSource& source, std::size_t most, const SensorConfig& sensor);

}  // namespace planemap::benchmark

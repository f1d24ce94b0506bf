#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <planemap/sources/frame_source.hpp>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace planemap::benchmark {

/// Where a program's frames come from.
struct FrameOptions {
  std::string dataset;     ///< folder; empty: a simulated apartment
  std::uint64_t seed = 1;  ///< of the apartment
};

/// Adds --dataset and --seed.
void define_frame_options(CLI::App& app, FrameOptions& options);

/// Opens them.
/// @param tour  frames in which the simulated camera goes through the apartment; empty: at a robot's own speed
/// Throws std::runtime_error where the folder cannot be used.
std::unique_ptr<sources::FrameSource> open_frames(const FrameOptions& options, std::optional<std::size_t> tour);

/// Reads up to so many.
std::vector<sources::Frame> read_frames(sources::FrameSource& source, std::size_t most);

}  // namespace planemap::benchmark

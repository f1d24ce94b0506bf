#include "frame_source.hpp"

#include <CLI/CLI.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/sources/open_folder.hpp>
#include <stdexcept>
#include <utility>

namespace planemap::benchmark {

void define_frame_options(CLI::App& app, FrameOptions& options) {
  app.add_option("--dataset", options.dataset, "frames of a 7-Scenes or TUM RGB-D folder; else a simulated apartment")
      ->type_name("DIR");
  app.add_option("--seed", options.seed, "of the simulated apartment")->capture_default_str();
}

std::unique_ptr<sources::FrameSource> open_frames(const FrameOptions& options, std::optional<std::size_t> tour) {
  if (options.dataset.empty()) {
    simulation::SimulationConfig scene;
    scene.seed = options.seed;
    if (tour) scene.frames = *tour;
    return std::make_unique<simulation::SimulatedSource>(scene);
  }
  auto source = sources::open_folder(options.dataset);
  if (!source) throw std::runtime_error(source.error().message);
  return std::move(*source);
}

std::vector<sources::Frame> read_frames(sources::FrameSource& source, std::size_t most) {
  std::vector<sources::Frame> frames;
  while (frames.size() < most) {
    auto frame = source.next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
  }
  return frames;
}

}  // namespace planemap::benchmark

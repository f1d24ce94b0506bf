#include "scene_run.hpp"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <numeric>
#include <planemap/mapper.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <random>
#include <utility>

namespace planemap::accuracy {

namespace {

constexpr std::size_t kApartmentFrames = 300;

simulation::SimulationConfig simulation_of(const RunConfig& config) {
  simulation::SimulationConfig scene;
  scene.scene = config.scene;
  scene.seed = config.seed;
  scene.frames = config.frames;
  if (config.scene == "apartment" && !config.frames) scene.frames = kApartmentFrames;
  scene.depth_noise.scale = config.noise_scale;
  scene.pose_noise.sigma_m = config.pose_sigma_m;
  scene.pose_noise.sigma_rad = config.pose_sigma_deg * std::numbers::pi / 180.0;
  scene.pose_noise.correlation_s = config.pose_correlation_s;
  return scene;
}

}  // namespace

RecordedScene record_scene(const RunConfig& config) {
  simulation::SimulatedSource source(simulation_of(config));
  RecordedScene scene{{}, SeenSurfaces(source.truth(), config.mapping.sensor.max_range_m)};
  while (auto frame = source.next()) {
    scene.seen.add(source, frame->scan);
    scene.frames.push_back(std::move(*frame));
  }
  return scene;
}

std::shared_ptr<const MapSnapshot> map_frames(const RecordedScene& scene, const MapperConfig& mapping,
                                              std::optional<std::uint64_t> shuffle) {
  std::vector<std::size_t> order(scene.frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (shuffle) {
    // By hand: std::shuffle differs between libraries.
    std::mt19937_64 bits(*shuffle);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[bits() % i]);
  }
  Mapper mapper(mapping, /*epoch=*/1);
  for (const std::size_t i : order) mapper.integrate(scene.frames[i].scan, scene.frames[i].T_world_sensor);
  return mapper.snapshot();
}

MappedScene map_scene(const RunConfig& config) {
  simulation::SimulatedSource source(simulation_of(config));
  Mapper mapper(config.mapping, /*epoch=*/1);
  SeenSurfaces seen(source.truth(), config.mapping.sensor.max_range_m);
  std::chrono::steady_clock::duration spent{};
  std::size_t scans = 0;
  std::size_t worn_cells = 0;
  while (auto frame = !config.until || scans < *config.until ? source.next() : std::nullopt) {
    seen.add(source, frame->scan);
    const Scan scan = std::move(frame->scan);
    const auto begin = std::chrono::steady_clock::now();
    worn_cells += mapper.integrate(scan, frame->T_world_sensor).worn_cells;
    spent += std::chrono::steady_clock::now() - begin;
    ++scans;
  }
  const double ms_per_scan =
      std::chrono::duration<double, std::milli>(spent).count() / static_cast<double>(std::max<std::size_t>(scans, 1));
  return {mapper.snapshot(), std::move(seen), ms_per_scan, worn_cells};
}

Run run_scene(const RunConfig& config) {
  const MappedScene mapped = map_scene(config);
  return {score(*mapped.map, mapped.seen, config.scoring), mapped.ms_per_scan, mapped.map->cell_count(),
          mapped.worn_cells};
}

}  // namespace planemap::accuracy

#include "apartment_run.hpp"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <numeric>
#include <planemap/mapper.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <vector>

namespace planemap::accuracy {

Run run_apartment(const RunConfig& config) {
  simulation::SimulationConfig scene;
  scene.seed = config.seed;
  scene.frames = config.frames;
  scene.depth_noise.scale = config.noise_scale;
  scene.pose_noise.sigma_m = config.pose_sigma_m;
  scene.pose_noise.sigma_rad = config.pose_sigma_deg * std::numbers::pi / 180.0;
  scene.pose_noise.correlation_s = config.pose_correlation_s;
  simulation::SimulatedSource source(scene);

  Mapper mapper(config.mapping, /*epoch=*/1);
  SeenSurfaces seen(source.truth(), config.mapping.sensor.max_range_m);
  std::chrono::steady_clock::duration spent{};
  std::size_t scans = 0;
  while (auto frame = source.next()) {
    seen.add(source, frame->scan);
    const Scan scan = std::move(frame->scan);
    const auto begin = std::chrono::steady_clock::now();
    mapper.integrate(scan, frame->T_world_sensor);
    spent += std::chrono::steady_clock::now() - begin;
    ++scans;
  }
  Run run;
  run.score = score(*mapper.snapshot(), seen);
  run.ms_per_scan =
      std::chrono::duration<double, std::milli>(spent).count() / static_cast<double>(std::max<std::size_t>(scans, 1));
  return run;
}

Summary summarise(std::span<const Run> runs) {
  Summary s;
  double seen_m2 = 0.0;
  double labelled_m2 = 0.0;
  std::vector<double> nees;
  for (const Run& run : runs) {
    s.surfaces += run.score.surfaces.size();
    s.correct += run.score.count(Verdict::kCorrect);
    s.over += run.score.count(Verdict::kOverSegmented);
    s.under += run.score.count(Verdict::kUnderSegmented);
    s.missed += run.score.count(Verdict::kMissed);
    s.noise += run.score.noise.size();
    seen_m2 += run.score.seen_m2();
    labelled_m2 += run.score.labelled_m2();
    s.ms_per_scan += run.ms_per_scan / static_cast<double>(runs.size());
    for (const SurfaceScore& surface : run.score.surfaces) {
      if (surface.verdict != Verdict::kCorrect) continue;
      s.normal_mean_deg += surface.normal_error_deg;
      s.normal_max_deg = std::max(s.normal_max_deg, surface.normal_error_deg);
      s.offset_mean_m += surface.offset_error_m;
      s.offset_max_m = std::max(s.offset_max_m, surface.offset_error_m);
      nees.push_back(surface.nees);
    }
  }
  s.labelled_share = seen_m2 > 0.0 ? labelled_m2 / seen_m2 : 0.0;
  if (nees.empty()) return s;
  s.normal_mean_deg /= static_cast<double>(nees.size());
  s.offset_mean_m /= static_cast<double>(nees.size());
  const auto middle = nees.begin() + static_cast<std::ptrdiff_t>(nees.size() / 2);
  std::nth_element(nees.begin(), middle, nees.end());
  s.nees_median = *middle;
  const auto count = static_cast<double>(nees.size());
  const auto share = [&](double low, double high) {
    return static_cast<double>(
               std::count_if(nees.begin(), nees.end(), [&](double n) { return n >= low && n < high; })) /
           count;
  };
  s.nees_mean = std::accumulate(nees.begin(), nees.end(), 0.0) / count;
  s.nees_below = share(0.0, 7.81);
  s.nees_within = share(0.216, 9.35);
  return s;
}

}  // namespace planemap::accuracy

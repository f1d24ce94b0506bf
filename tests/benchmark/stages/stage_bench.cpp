// planemap-stage-bench: each stage of the pipeline by itself, for each instruction set where it matters.
#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <planemap/block.hpp>
#include <planemap/plane_statistics.hpp>
#include <string>

#include "common/quantile.hpp"
#include "serve/lcm/delta_maker.hpp"
#include "stages/kernels.hpp"
#include "stages/settled_map.hpp"

namespace planemap::benchmark {

namespace {

using ::benchmark::DoNotOptimize;
using ::benchmark::State;

struct NamedTarget {
  const char* name;
  SimdTarget target;
};
constexpr NamedTarget kTargets[] = {{"avx2", SimdTarget::kAvx2},
                                    {"avx512", SimdTarget::kAvx512},
                                    {"sse4", SimdTarget::kSse4},
                                    {"neon", SimdTarget::kNeon},
                                    {"scalar", SimdTarget::kScalar}};

/// Maps of the same frames, one for each configuration; made when first asked for.
class Maps {
 public:
  explicit Maps(StageFrames frames) : frames_(std::move(frames)) {}

  const StageFrames& frames() const { return frames_; }
  SettledMap& of(SimdTarget target, bool second_surfaces) {
    auto& map = maps_[{target, second_surfaces}];
    if (!map) {
      MapperConfig config = preset(Preset::kBest);
      config.core.simd = target;
      config.grid.second_surfaces = second_surfaces;
      map = std::make_unique<SettledMap>(config, frames_.frames);
    }
    return *map;
  }

 private:
  StageFrames frames_;
  std::map<std::pair<SimdTarget, bool>, std::unique_ptr<SettledMap>> maps_;
};

/// Times what take() says that an iteration took, in milliseconds: the thread's own time.
template <class Take>
void measure(State& state, Take&& take) {
  std::vector<double> ms;
  for (auto _ : state) {
    ms.push_back(take());
    state.SetIterationTime(1e-3 * ms.back());
  }
  state.counters["median_ms"] = median(ms);
  state.counters["p95_ms"] = quantile(ms, 0.95);
}

template <class Run>
void add(const std::string& name, int iterations, Run&& run) {
  ::benchmark::RegisterBenchmark(name.c_str(), run)
      ->Iterations(iterations)
      ->UseManualTime()
      ->Unit(::benchmark::kMillisecond);
}

void stage(State& state, SettledMap& map, Stage stage) {
  measure(state, [&] {
    map.map_next();
    return map.stages().own_ms(static_cast<std::size_t>(stage));
  });
}

void whole(State& state, SettledMap& map) {
  measure(state, [&] {
    map.map_next();
    return map.whole_own_ms();
  });
}

void projection(State& state, const StageFrames& frames, SimdTarget target) {
  std::size_t at = 0;
  measure(state, [&] {
    const DepthScan& scan = frames.frames[at++ % frames.frames.size()].scan;
    const Stopwatch watch;
    DoNotOptimize(project_image(scan, 0.08, target));
    return watch.own_ms();
  });
}

/// What has changed since the scan before as messages: on the publisher's thread, not the mapper's.
void delta(State& state, SettledMap& map) {
  const service::ServiceConfig config;
  service::PlaneBook book(config.map);
  service::DeltaMaker deltas(config, book);
  deltas.make(map.snapshot());
  std::size_t bytes = 0;
  measure(state, [&] {
    map.map_next();
    const Stopwatch watch;
    const service::Pages pages = deltas.make(map.snapshot());
    const double ms = watch.own_ms();
    for (const auto& page : pages) bytes += page.size();
    return ms;
  });
  state.counters["bytes"] = static_cast<double>(bytes) / static_cast<double>(state.iterations());
}

/// The cells of the largest plane, and what is known of them together.
struct LargestPlane {
  std::vector<std::pair<Cell, Eigen::Vector3d>> cells;  // with its geometric centre
  PlaneStatistics statistics{Eigen::Vector3d::Zero()};

  explicit LargestPlane(const MapSnapshot& map) {
    const auto largest = std::max_element(map.planes().begin(), map.planes().end(),
                                          [](const auto& a, const auto& b) { return a->cell_count < b->cell_count; });
    statistics = PlaneStatistics((*largest)->centroid_m);
    for (const auto& block : map.blocks()) {
      for (std::size_t i = 0; i < block->size(); ++i) {
        const Cell& cell = block->cell(i);
        if (cell.plane != (*largest)->id) continue;
        const Eigen::Vector3d centre_m =
            (block->cell_index(i).cast<double>().array() + 0.5).matrix() * map.cell_size_m();
        cells.emplace_back(cell, centre_m);
        statistics.add(cell, centre_m);
      }
    }
  }
};

/// A cell leaves its plane and joins it again, as each cell that gets points does.
void refit_cells(State& state, const LargestPlane& plane) {
  PlaneStatistics statistics = plane.statistics;
  measure(state, [&] {
    const Stopwatch watch;
    for (const auto& [cell, centre_m] : plane.cells) {
      statistics.remove(cell, centre_m);
      statistics.add(cell, centre_m);
    }
    return watch.own_ms();
  });
  state.counters["cells"] = static_cast<double>(plane.cells.size());
}

/// Fit and covariance of one plane from its sums; a thousand times.
void refit_plane(State& state, const LargestPlane& plane) {
  constexpr int kTimes = 1000;
  measure(state, [&] {
    const Stopwatch watch;
    for (int i = 0; i < kTimes; ++i) {
      const auto fit = plane.statistics.fit(/*pooled=*/true);
      if (fit) DoNotOptimize(covariance_of(*fit, sensor_covariance(*fit, 5e-5)));
    }
    return watch.own_ms();
  });
  state.counters["planes"] = kTimes;
}

void add_all(Maps& maps, int iterations) {
  for (const NamedTarget& simd : kTargets) {
    if (!is_supported(simd.target)) continue;
    const auto named = [&](const std::string& stage) { return stage + "/" + simd.name; };
    const SimdTarget target = simd.target;
    add(named("depthToPoints"), iterations,
        [&maps, target](State& state) { projection(state, maps.frames(), target); });
    add(named("assign"), iterations,
        [&maps, target](State& state) { stage(state, maps.of(target, true), Stage::kAssign); });
    add(named("assign/withoutSecondSurfaces"), iterations,
        [&maps, target](State& state) { stage(state, maps.of(target, false), Stage::kAssign); });
    add(named("whole"), iterations, [&maps, target](State& state) { whole(state, maps.of(target, true)); });
  }
  for (const Stage which :
       {Stage::kNormals, Stage::kLocalPlanes, Stage::kGlobalPlanes, Stage::kWear, Stage::kSnapshot}) {
    add(name_of(which), iterations,
        [&maps, which](State& state) { stage(state, maps.of(SimdTarget::kAuto, true), which); });
  }
  add("delta", iterations, [&maps](State& state) { delta(state, maps.of(SimdTarget::kAuto, true)); });
  add("refit/cells", iterations,
      [&maps](State& state) { refit_cells(state, LargestPlane(*maps.of(SimdTarget::kAuto, true).snapshot())); });
  add("refit/1000Planes", iterations,
      [&maps](State& state) { refit_plane(state, LargestPlane(*maps.of(SimdTarget::kAuto, true).snapshot())); });
}

int run(int argc, char** argv) {
  ::benchmark::Initialize(&argc, argv);
  CLI::App app("planemap-stage-bench: what each stage of a scan takes", "planemap-stage-bench");
  std::size_t frames = 150;
  int iterations = 150;
  app.add_option("--frames", frames, "that are mapped over and over")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--iterations", iterations, "scans of each benchmark")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.footer("Google Benchmark's own options (--benchmark_filter=REGEX, --benchmark_format=json, ...) work, too.");
  CLI11_PARSE(app, argc, argv);
  Maps maps(read_stage_frames(frames));
  ::benchmark::AddCustomContext("frames",
                                std::to_string(maps.frames().frames.size()) + " of the " + maps.frames().name);
  add_all(maps, iterations);
  ::benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace

}  // namespace planemap::benchmark

int main(int argc, char** argv) {
  try {
    return planemap::benchmark::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "planemap-stage-bench: %s\n", e.what());
    return 1;
  }
}

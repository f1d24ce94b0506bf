// planemap-query-bench: what queries on a snapshot take, in process, on one thread. Google Benchmark, with the 99th
// percentile over all queries as a counter: that is what a robot waits for.
#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <planemap/query/snapshot_queries.hpp>
#include <random>
#include <vector>

#include "query_scene.hpp"
#include "rtree_nearest.hpp"

namespace planemap::benchmark {

namespace {

using ::benchmark::DoNotOptimize;
using ::benchmark::State;
using Eigen::Vector3d;

const Vector3d kDown = -Vector3d::UnitZ();

/// What all benchmarks ask.
struct Subject {
  explicit Subject(std::size_t planes) : scene(planes), queries(scene.snapshot(), kDown), rtree(queries.planes()) {}

  QueryScene scene;
  SnapshotQueries queries;
  RtreeNearest rtree;
};

double now_us(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return 1e6 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_nsec);
}

class Times {
 public:
  void add(double us) { us_.push_back(us); }
  double last_us() const { return us_.back(); }
  double quantile_us(double q) {
    const auto at = us_.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(us_.size() - 1));
    std::nth_element(us_.begin(), at, us_.end());
    return *at;
  }

 private:
  std::vector<double> us_;
};

/// Times ask() by itself for arguments that prepare() draws: by the clock, and by the thread's own time, which a busy
/// machine does not lengthen (but for what reading it takes, some tenths of a microsecond).
template <class Prepare, class Ask>
void measure(State& state, Prepare&& prepare, Ask&& ask) {
  std::mt19937_64 random(7);
  Times wall;
  Times own;
  double named = 0.0;
  for (auto _ : state) {
    const auto arguments = prepare(random);
    const double own_begin_us = now_us(CLOCK_THREAD_CPUTIME_ID);
    const double begin_us = now_us(CLOCK_MONOTONIC);
    named += static_cast<double>(ask(arguments));
    wall.add(now_us(CLOCK_MONOTONIC) - begin_us);
    own.add(now_us(CLOCK_THREAD_CPUTIME_ID) - own_begin_us);
    state.SetIterationTime(1e-6 * wall.last_us());
  }
  state.counters["found"] = named / static_cast<double>(state.iterations());
  state.counters["p50_us"] = wall.quantile_us(0.5);
  state.counters["p99_us"] = wall.quantile_us(0.99);
  state.counters["own_p50_us"] = own.quantile_us(0.5);
  state.counters["own_p99_us"] = own.quantile_us(0.99);
}

Vector3d direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

void nearest(State& state, const Subject& subject, std::size_t count, double outside_m) {
  measure(
      state,
      [&](std::mt19937_64& random) {
        NearestQuery query;
        query.point_m = subject.scene.place(random) + outside_m * direction(random);
        query.covariance_m2 = 1e-4 * Eigen::Matrix3d::Identity();
        query.count = count;
        return query;
      },
      [&](const NearestQuery& query) { return subject.queries.nearest(query)->size(); });
}

void nearest_by_rtree(State& state, const Subject& subject) {
  measure(
      state, [&](std::mt19937_64& random) { return subject.scene.place(random); },
      [&](const Vector3d& p_m) { return subject.rtree.nearest(p_m) == kNoPlane ? 0U : 1U; });
}

void cast(State& state, const Subject& subject, bool planes, bool cells, double above_m) {
  measure(
      state,
      [&](std::mt19937_64& random) {
        const Vector3d from_m = subject.scene.place(random) + above_m * Vector3d::UnitZ();
        return Ray{from_m, direction(random)};
      },
      [&](const Ray& ray) {
        const auto hits = subject.queries.cast(std::span(&ray, 1), CastOptions{planes, cells, {}});
        return (hits->front().plane ? 1U : 0U) + (hits->front().cell ? 1U : 0U);
      });
}

/// 5 m across and longer, as a robot looks.
Region region_at(const Vector3d& p_m, const Vector3d& towards, const std::string& kind) {
  if (kind == "box") return BoxRegion{p_m - Vector3d::Constant(2.5), p_m + Vector3d::Constant(2.5)};
  if (kind == "sphere") return SphereRegion{p_m, 5.0};
  if (kind == "cylinder") return CylinderRegion{p_m, p_m + 5.0 * towards, 1.0};
  Eigen::Isometry3d T(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), towards));
  T.pretranslate(p_m);
  if (kind == "orientedBox") return OrientedBoxRegion{T, Vector3d::Constant(5.0)};
  return FrustumRegion{T, 1.0, 0.8, 0.5, 5.0};
}

void region(State& state, const Subject& subject, const std::string& kind, bool polygons, bool cells) {
  measure(
      state,
      [&](std::mt19937_64& random) {
        const Vector3d p_m = subject.scene.place(random);
        return RegionQuery{region_at(p_m, direction(random), kind), polygons, cells, {}};
      },
      [&](const RegionQuery& query) {
        const auto found = subject.queries.region(query);
        return found->planes.size() + found->cells.size();
      });
}

void plane(State& state, const Subject& subject) {
  std::uniform_int_distribution<PlaneId> id(1, subject.queries.planes().size());
  measure(state, id, [&](PlaneId asked) { return subject.queries.plane(asked)->details->coplanar.size(); });
}

void floorplan(State& state, const Subject& subject) {
  measure(
      state, [](std::mt19937_64&) { return FloorplanQuery{}; },
      [&](const FloorplanQuery& query) { return subject.queries.floorplan(query)->free_floor.size(); });
}

/// Making the index anew, or from one of the revision before.
void make(State& state, const Subject& subject, bool anew, std::size_t changed) {
  measure(
      state, [&](std::mt19937_64&) { return subject.scene.seen_again(changed); },
      [&](const std::shared_ptr<const MapSnapshot>& snapshot) {
        return SnapshotQueries(snapshot, kDown, anew ? nullptr : &subject.queries).planes().size();
      });
}

template <class Run>
void add(const std::string& name, int iterations, Run&& run) {
  ::benchmark::RegisterBenchmark(name.c_str(), run)
      ->Iterations(iterations)
      ->UseManualTime()
      ->Unit(::benchmark::kMicrosecond);
}

void add_all(const Subject& s, int iterations) {
  const int few = std::max(iterations / 2000, 2);
  add("nearest/1", iterations, [&](State& state) { nearest(state, s, 1, 0.0); });
  add("nearest/8", iterations, [&](State& state) { nearest(state, s, 8, 0.0); });
  add("nearest/1/20mAway", iterations, [&](State& state) { nearest(state, s, 1, 20.0); });
  add("nearest/1/boostRtree", iterations, [&](State& state) { nearest_by_rtree(state, s); });
  add("cast/planes", iterations, [&](State& state) { cast(state, s, true, false, 0.0); });
  add("cast/cells", iterations, [&](State& state) { cast(state, s, false, true, 0.0); });
  add("cast/both", iterations, [&](State& state) { cast(state, s, true, true, 0.0); });
  add("cast/both/fromAbove", iterations, [&](State& state) { cast(state, s, true, true, 5.0); });
  for (const char* kind : {"box", "orientedBox", "sphere", "frustum", "cylinder"}) {
    const std::string name = std::string("region/") + kind;
    add(name, iterations / 10, [&s, kind](State& state) { region(state, s, kind, false, false); });
    add(name + "/polygons", iterations / 10, [&s, kind](State& state) { region(state, s, kind, true, false); });
    add(name + "/cells", iterations / 10, [&s, kind](State& state) { region(state, s, kind, false, true); });
  }
  add("plane", iterations / 10, [&](State& state) { plane(state, s); });
  add("floorplan", few, [&](State& state) { floorplan(state, s); });
  add("make/anew", few, [&](State& state) { make(state, s, true, 0); });
  add("make/50Changed", few, [&](State& state) { make(state, s, false, 50); });
  add("make/0Changed", few, [&](State& state) { make(state, s, false, 0); });
}

}  // namespace

}  // namespace planemap::benchmark

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  CLI::App app("planemap-query-bench: what queries on a snapshot take", "planemap-query-bench");
  std::size_t planes = 10'000;
  int iterations = 20'000;
  app.add_option("--planes", planes, "of the made-up building")->check(CLI::Range(40, 100'000))->capture_default_str();
  app.add_option("--iterations", iterations, "of the quick queries")
      ->check(CLI::Range(100, 10'000'000))
      ->capture_default_str();
  app.footer("Google Benchmark's own options (--benchmark_filter=REGEX, --benchmark_format=json, ...) work, too.");
  CLI11_PARSE(app, argc, argv);
  const planemap::benchmark::Subject subject(planes);
  const auto& map = subject.queries.snapshot();
  benchmark::AddCustomContext("map", std::to_string(subject.queries.planes().size()) + " planes, " +
                                         std::to_string(map.cell_count()) + " cells in " +
                                         std::to_string(map.block_count()) + " blocks");
  planemap::benchmark::add_all(subject, iterations);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

#include "scale/scale_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <planemap/mapper.hpp>
#include <planemap/simulation/scenes.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <utility>

#include "common/quantile.hpp"
#include "scale/reader.hpp"

namespace planemap::benchmark {

namespace {

constexpr std::size_t kBatch = 50;       // frames that are rendered at a time
constexpr std::size_t kTwinScans = 250;  // of each window, the first, which the twin maps, too
constexpr std::size_t kTwinGrows = 100;  // of these, the first that are not compared

double rss_mb() {
  std::ifstream file("/proc/self/statm");
  double pages = 0.0;
  double resident = 0.0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double floor_m2(const simulation::SimulatedSource& source) {
  for (const simulation::Surface& surface : source.truth()) {
    if (surface.name == "floor") return area_m2(surface);
  }
  return 0.0;
}

/// Times of the scans of a window.
struct WindowTimes {
  std::vector<double> scan_ms;
  std::vector<double> own_ms;
  std::vector<double> publish_ms;
  std::vector<double> publish_own_ms;
  std::vector<double> with_twin_own_ms;
  std::vector<double> twin_own_ms;
};

class ScaleRun {
 public:
  explicit ScaleRun(const ScaleConfig& config)
      : config_(config), source_(building(config)), mapper_(config.mapper, /*epoch=*/1), reader_(shelf_) {}

  std::vector<ScaleWindow> run(const std::function<void(const ScaleWindow&)>& on_window) {
    std::vector<ScaleWindow> windows;
    render();
    first_rss_mb_ = rss_mb();
    while (!batch_.empty()) {
      for (const sources::Frame& frame : batch_) {
        map(frame.scan, frame.T_world_sensor);
        if (scans_ % config_.window != 0 && scans_ != config_.scans) continue;
        windows.push_back(window());
        on_window(windows.back());
        if (since_begin_.ms() > 60e3 * config_.minutes) return windows;
      }
      render();
    }
    return windows;
  }

 private:
  static simulation::SimulationConfig building(const ScaleConfig& config) {
    simulation::SimulationConfig scene;
    scene.scene = simulation::kBuildingScene;
    scene.seed = config.seed;
    scene.frames = config.scans;
    scene.time_lapse = config.time_lapse;
    PinholeIntrinsics& k = scene.intrinsics;
    k.width /= config.shrink;
    k.height /= config.shrink;
    for (double* px : {&k.fx, &k.fy, &k.cx, &k.cy}) *px /= config.shrink;
    return scene;
  }

  void render() {
    batch_.clear();
    while (batch_.size() < kBatch) {
      auto frame = source_.next();
      if (!frame) return;
      batch_.push_back(std::move(*frame));
    }
  }

  void map(const Scan& scan, const Eigen::Isometry3d& T_world_sensor) {
    const std::size_t of_window = scans_ % config_.window;
    if (of_window == 0) begin_twin();
    // Who goes second finds the scan in the caches: they take turns.
    const bool twin_first = scans_ % 2 == 1;
    double twin_ms = twin_ && twin_first ? map_twin(scan, T_world_sensor) : 0.0;
    const Stopwatch whole;
    mapper_.integrate(scan, T_world_sensor);
    const Stopwatch publishing;
    shelf_.put(mapper_.snapshot()).reset();
    times_.publish_ms.push_back(publishing.ms());
    times_.publish_own_ms.push_back(publishing.own_ms());
    times_.scan_ms.push_back(whole.ms());
    times_.own_ms.push_back(whole.own_ms());
    if (twin_ && !twin_first) twin_ms = map_twin(scan, T_world_sensor);
    if (twin_ && of_window >= kTwinGrows) {
      times_.twin_own_ms.push_back(twin_ms);
      times_.with_twin_own_ms.push_back(times_.own_ms.back());
    }
    if (of_window + 1 == kTwinScans) end_twin();
    ++scans_;
  }

  void begin_twin() {
    end_twin();
    twin_.emplace(config_.mapper, /*epoch=*/2);
  }
  void end_twin() {
    twin_snapshot_.reset();
    twin_.reset();
  }

  /// @return own time, milliseconds
  double map_twin(const Scan& scan, const Eigen::Isometry3d& T_world_sensor) {
    const Stopwatch whole;
    twin_->integrate(scan, T_world_sensor);
    auto snapshot = twin_->snapshot();
    const double ms = whole.own_ms();
    twin_snapshot_.swap(snapshot);
    return ms;
  }

  ScaleWindow window() {
    const auto map = shelf_.take();
    const WindowTimes times = std::exchange(times_, {});
    std::vector<double> take_ms = reader_.take_times();
    if (take_ms.empty()) take_ms.push_back(0.0);  // a window of a few milliseconds
    ScaleWindow window;
    window.scans = scans_;
    window.area_m2 = floor_m2(source_);
    window.cells = map->cell_count();
    window.blocks = map->block_count();
    window.planes = map->planes().size();
    window.rss_mb = rss_mb() - first_rss_mb_;
    window.scan_ms = median(times.scan_ms);
    window.scan_p95_ms = quantile(times.scan_ms, 0.95);
    window.own_ms = median(times.own_ms);
    window.publish_ms = median(times.publish_ms);
    window.publish_p95_ms = quantile(times.publish_ms, 0.95);
    window.publish_own_ms = median(times.publish_own_ms);
    window.publish_own_max_ms = quantile(times.publish_own_ms, 1.0);
    window.take_ms = median(take_ms);
    window.take_p95_ms = quantile(take_ms, 0.95);
    window.take_max_ms = quantile(take_ms, 1.0);
    if (!times.twin_own_ms.empty()) {
      window.twin_own_ms = median(times.twin_own_ms);
      window.with_twin_own_ms = median(times.with_twin_own_ms);
    }
    return window;
  }

  Stopwatch since_begin_;
  ScaleConfig config_;
  simulation::SimulatedSource source_;
  Mapper mapper_;
  std::optional<Mapper> twin_;
  std::shared_ptr<const MapSnapshot> twin_snapshot_;  // what a reader of the twin's would hold
  std::vector<sources::Frame> batch_;
  std::size_t scans_ = 0;  // mapped
  double first_rss_mb_ = 0.0;
  WindowTimes times_;
  Shelf shelf_;
  Reader reader_;
};

}  // namespace

std::vector<ScaleWindow> run_scale(const ScaleConfig& config,
                                   const std::function<void(const ScaleWindow&)>& on_window) {
  return ScaleRun(config).run(on_window);
}

}  // namespace planemap::benchmark

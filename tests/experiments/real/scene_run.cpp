#include "real/scene_run.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <scan_points.hpp>
#include <stdexcept>

#include "real/accumulated_cloud.hpp"

namespace planemap::experiments {

namespace {

/// Notes the time of each stage of one scan.
class StageClock final : public StageObserver {
 public:
  explicit StageClock(std::array<double, kStageCount>& stage_ms) : stage_ms_(stage_ms) {}
  void stage_begins(Stage) override { begin_ = Clock::now(); }
  void stage_ends(Stage stage) override {
    stage_ms_[static_cast<std::size_t>(stage)] +=
        std::chrono::duration<double, std::milli>(Clock::now() - begin_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::array<double, kStageCount>& stage_ms_;
  Clock::time_point begin_;
};

std::vector<Eigen::Vector3f> world_points_m(const sources::Frame& frame, const SensorConfig& sensor) {
  std::vector<Eigen::Vector3f> points_m;
  points_m.reserve(frame.scan.depth.size());
  testing::for_each_point(frame.scan, frame.T_world_sensor, sensor, [&](const testing::UncertainPoint& point) {
    points_m.push_back(point.p_world_m.cast<float>());
  });
  return points_m;
}

ScanRecord map_one(Mapper& mapper, const Scan& scan, const Eigen::Isometry3d& T_world_sensor, double time_s) {
  ScanRecord record;
  record.time_s = time_s;
  StageClock clock(record.stage_ms);
  record.points = mapper.integrate(scan, T_world_sensor, &clock).points.mapped;
  const auto map = mapper.snapshot(&clock);
  record.planes = map->planes().size();
  record.large_planes =
      static_cast<std::size_t>(std::count_if(map->planes().begin(), map->planes().end(), [](const auto& plane) {
        return plane->cell_count >= ScanRecord::kLargeCells;
      }));
  return record;
}

}  // namespace

double ScanRecord::total_ms() const {
  return std::accumulate(stage_ms.begin(), stage_ms.end(), 0.0);
}

SceneRun map_scene(const std::string& name, const std::string& title, sources::FrameSource& source, double leaf_m,
                   const std::function<void(std::size_t)>& on_frame) {
  SceneRun run;
  run.name = name;
  run.title = title;
  run.up = -source.gravity_direction().value_or(-Eigen::Vector3d::UnitZ());
  run.leaf_m = leaf_m;
  run.presets.push_back({"best", preset(Preset::kBest), {}, nullptr});
  run.presets.push_back({"paper", preset(Preset::kPaper), {}, nullptr});
  std::vector<Mapper> mappers;
  for (const PresetRun& by : run.presets) mappers.emplace_back(by.config, /*epoch=*/1);
  AccumulatedCloud cloud(leaf_m);
  std::int64_t first_utime = 0;
  std::size_t frames = 0;
  while (auto frame = source.next()) {
    if (frames == 0) first_utime = frame->scan.utime;
    cloud.add(world_points_m(*frame, run.best().config.sensor));
    run.sensors_m.push_back(frame->T_world_sensor.translation());
    const double time_s = 1e-6 * static_cast<double>(frame->scan.utime - first_utime);
    const Scan scan = std::move(frame->scan);
    for (std::size_t i = 0; i < mappers.size(); ++i) {
      run.presets[i].scans.push_back(map_one(mappers[i], scan, frame->T_world_sensor, time_s));
    }
    ++frames;
    if (on_frame) on_frame(frames);
  }
  if (frames == 0) throw std::runtime_error(title + ": there is no frame");
  for (std::size_t i = 0; i < mappers.size(); ++i) run.presets[i].map = mappers[i].snapshot();
  run.cloud_m = cloud.points_m();
  return run;
}

}  // namespace planemap::experiments

#include "mapping/offline_builder.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "ingest/scan_intake.hpp"
#include "mapping/helper_thread.hpp"

namespace planemap::service {

class OfflineBuilder::Impl {
 public:
  Impl(const ServiceConfig& config, std::uint64_t epoch)
      : config_(config.mapper),
        first_epoch_(epoch),
        helper_(helper_thread_for(config.mapping.threads)),
        mapper_(config_, epoch, helper_.get()),
        intake_(
            config, counters_, [this](RegisteredScan&& scan) { map(scan); },
            [](const std::string&) { /* counted, and kept as last_problem(); a library has no log of its own */ }) {}

  bool add_event(std::string_view channel, std::span<const std::uint8_t> message) {
    return intake_.on_message(channel, message, kHostTimeStandsStillS);
  }

  ScanReport add_frame(const Scan& scan, const Eigen::Isometry3d& T_world_sensor) {
    counters_.scan_received();
    return map(scan, T_world_sensor, std::nullopt);
  }

  void finish() { intake_.finish(); }
  std::shared_ptr<const MapSnapshot> snapshot() { return mapper_.snapshot(); }
  CounterValues counters() const { return counters_.values(); }
  const PointCounts& points() const { return points_; }
  const StageTimes& times() const { return times_; }
  std::string last_problem() const { return intake_.last_problem(); }

 private:
  /// In a recording only the messages' own time counts.
  static constexpr double kHostTimeStandsStillS = 0.0;

  void map(const RegisteredScan& scan) {
    if (scan.map_number > map_number_) begin_new_map(scan.map_number);
    map(scan.scan, scan.T_world_sensor, scan.pose_covariance);
  }

  void begin_new_map(std::uint64_t map_number) {
    mapper_ = Mapper(config_, first_epoch_ + map_number, helper_.get());
    map_number_ = map_number;
    counters_.add("map.resets");
  }

  ScanReport map(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                 const std::optional<PoseCovariance>& pose_covariance) {
    timer_.reset();
    const auto begin = StageTimer::Clock::now();
    const ScanReport report = mapper_.integrate(scan, T_world_sensor, &timer_, pose_covariance);
    const std::chrono::duration<double, std::milli> ms = StageTimer::Clock::now() - begin;
    counters_.scan_mapped(report.points);
    counters_.add("cells.worn", static_cast<std::int64_t>(report.worn_cells));
    points_ += report.points;
    times_.scan_ms.push_back(ms.count());
    for (std::size_t i = 0; i < kStageCount; ++i) times_.stage_ms[i].push_back(timer_.ms()[i]);
    return report;
  }

  const MapperConfig config_;
  const std::uint64_t first_epoch_;
  Counters counters_;
  const std::unique_ptr<HelperThread> helper_;
  Mapper mapper_;
  std::uint64_t map_number_ = 0;
  StageTimer timer_;
  StageTimes times_;
  PointCounts points_;
  ScanIntake intake_;
};

OfflineBuilder::OfflineBuilder(const ServiceConfig& config, std::uint64_t epoch)
    : impl_(std::make_unique<Impl>(config, epoch)) {}
OfflineBuilder::~OfflineBuilder() = default;

bool OfflineBuilder::add_event(std::string_view channel, std::span<const std::uint8_t> message) {
  return impl_->add_event(channel, message);
}
ScanReport OfflineBuilder::add_frame(const Scan& scan, const Eigen::Isometry3d& T_world_sensor) {
  return impl_->add_frame(scan, T_world_sensor);
}
void OfflineBuilder::finish() {
  impl_->finish();
}
std::shared_ptr<const MapSnapshot> OfflineBuilder::snapshot() {
  return impl_->snapshot();
}
CounterValues OfflineBuilder::counters() const {
  return impl_->counters();
}
const PointCounts& OfflineBuilder::points() const {
  return impl_->points();
}
const StageTimes& OfflineBuilder::times() const {
  return impl_->times();
}
std::string OfflineBuilder::last_problem() const {
  return impl_->last_problem();
}

}  // namespace planemap::service

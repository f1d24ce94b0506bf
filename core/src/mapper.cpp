#include "planemap/mapper.hpp"

#include <array>
#include <utility>

#include "map_addition.hpp"
#include "planemap/assignment.hpp"
#include "planemap/cell_normals.hpp"
#include "planemap/local_planes.hpp"
#include "planemap/map_check.hpp"
#include "planemap/neighbourhoods.hpp"
#include "planemap/plane_map.hpp"
#include "planemap/pool.hpp"
#include "planemap/uncertain_grid.hpp"
#include "planemap/wear.hpp"

namespace planemap {

namespace {

/// Tells the observer of a stage for as long as it lives.
class StageScope {
 public:
  StageScope(StageObserver* observer, Stage stage) : observer_(observer), stage_(stage) {
    if (observer_ != nullptr) observer_->stage_begins(stage_);
  }
  ~StageScope() {
    if (observer_ != nullptr) observer_->stage_ends(stage_);
  }
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;

 private:
  StageObserver* observer_;
  Stage stage_;
};

/// Removed planes that a snapshot still names; a reader that is farther behind takes the whole map.
constexpr std::size_t kKeptRemovals = 4096;

}  // namespace

class Mapper::Impl {
 public:
  Impl(const MapperConfig& config, std::uint64_t epoch, SecondThread* second)
      : config_(config),
        epoch_(epoch),
        second_(second),
        grid_(config.grid.cell_size_m),
        assigner_(config.core, config.sensor, config.grid, second),
        normals_{NormalEstimator(config.normals), NormalEstimator(config.normals)},
        local_(config.grid, config.normals, config.planes),
        planes_(config.grid, config.planes, config.pose_error),
        wear_(config.wear, config.sensor, config.grid.cell_size_m) {}

  /// @pre the map was checked
  void restore(const MapSnapshot& map) {
    revision_ = map.revision();
    utime_ = map.utime();
    for (const auto& block : map.blocks()) grid_.add_block(block);
    planes_.restore(grid_, map.planes(), map.state());
    records_.assign(map.planes().begin(), map.planes().end());
    removed_.assign(map.removed().begin(), map.removed().end());
    removed_complete_since_ = map.removed_complete_since();
  }

  ScanReport integrate(const Scan& scan, const ScanPose& pose, StageObserver* observer) {
    ScanReport report;
    utime_ = std::max(utime_, pose.utime);
    assign(scan, pose.T_world_sensor, observer, report);
    fit_normals(observer);
    std::span<const LocalPlane> local;
    std::span<const CellRef> worn;
    do_both(
        second_,
        [&] {
          const StageScope scope(observer, Stage::kLocalPlanes);  // Fig. 3, lines 4 and 5
          local = local_.extract(grid_, assigner_.changes(), neighbourhoods_);
        },
        [&] {
          if (!config_.wear.enabled) return;
          const StageScope scope(second_ == nullptr ? observer : nullptr, Stage::kWear);
          worn = wear_.look(grid_, scan, pose.T_world_sensor, assigner_.changes());
        });
    {
      const StageScope scope(observer, Stage::kGlobalPlanes);  // Fig. 3, lines 6 to 9
      const GlobalReport global = planes_.merge(grid_, local, assigner_.changes(), neighbourhoods_, pose);
      report.local_planes = local.size();
      report.new_planes = global.new_planes;
      report.merged_planes = global.merged_planes;
    }
    wear_away(worn, observer, report);
    assigner_.finish(grid_);
    report.planes_changed = planes_.changed();
    if (report.planes_changed) ++revision_;
    return report;
  }

  AdditionReport add(const MapSnapshot& other, const std::optional<Eigen::Isometry3d>& T_ours_theirs,
                     const std::function<void(double)>& progress) {
    utime_ = std::max(utime_, other.utime());
    MapAddition addition(other, T_ours_theirs);
    addition.add_cells(grid_, planes_);
    AdditionReport report{other.cell_count(), 0, 0};
    std::vector<CellChange>& changes = assigner_.changes();
    for (std::size_t batch = 0; batch < addition.batch_count(); ++batch) {
      addition.begin_batch(batch, grid_, changes);
      for (const CellChange& change : changes) planes_.detach(grid_, change.cell);
      fit_normals(nullptr);
      const auto local = local_.extract(grid_, changes, neighbourhoods_);
      const GlobalReport global =
          planes_.merge(grid_, local, changes, neighbourhoods_, addition.pose_of(grid_, changes));
      report.new_planes += global.new_planes;
      report.merged_planes += global.merged_planes;
      assigner_.finish(grid_);
      if (progress) progress(static_cast<double>(batch + 1) / static_cast<double>(addition.batch_count()));
    }
    addition.note_times(grid_, planes_);
    if (planes_.changed()) ++revision_;
    return report;
  }

  const MapperConfig& config() const { return config_; }

  std::shared_ptr<const MapSnapshot> snapshot(StageObserver* observer) {
    const StageScope scope(observer, Stage::kSnapshot);
    planes_.update_records(revision_, records_, removed_);
    trim_removals();
    const std::shared_ptr<MapSnapshot> snapshot = snapshots_.take();
    MapSnapshot::Parts& parts = snapshot->parts();
    parts.epoch = epoch_;
    parts.revision = revision_;
    parts.utime = utime_;
    parts.cell_size_m = config_.grid.cell_size_m;
    parts.density_threshold = config_.grid.density_threshold;
    parts.cell_count = grid_.cell_count();
    parts.removed_complete_since = removed_complete_since_;
    parts.planes = records_;
    parts.removed = removed_;
    parts.state = planes_.state();
    grid_.share(parts.blocks);
    return snapshot;
  }

 private:
  /// Fig. 3, lines 2 and 3: map the scan onto the grid, maintain the cells' statistics.
  void assign(const Scan& scan, const Eigen::Isometry3d& T_world_sensor, StageObserver* observer, ScanReport& report) {
    const StageScope scope(observer, Stage::kAssign);
    report.points = assigner_.assign(grid_, scan, T_world_sensor, dividing_planes());
    report.touched_cells = assigner_.changes().size();
    for (CellChange& change : assigner_.changes()) {
      planes_.detach(grid_, change.cell);
      add(change, T_world_sensor);
    }
  }

  DividingPlanes dividing_planes() const {
    return {[this](PlaneSlot slot) { return planes_.dividing_plane(slot); }, planes_.pose_variance_m2()};
  }

  /// Adds what the scan saw to a cell.
  void add(CellChange& change, const Eigen::Isometry3d& T_world_sensor) {
    Cell& cell = grid_.writable(change.cell);
    const Eigen::Vector3d ray_m =
        grid_.geometric_centre_m(change.cell) + change.added.points.mean() - T_world_sensor.translation();
    double depth_m = T_world_sensor.linear().col(2).dot(ray_m);
    if (cell.plane == kNoSlot) {
      change.trust = range_trust(depth_m);
      cell.add(change.added, cell.direction(change.added), change.trust);
      return;
    }
    // Where the ray meets the plane: the same for all layers of cells that the noise is spread over.
    const Plane& plane = planes_.plane(cell.plane);
    const double slope = plane.normal().dot(ray_m);
    if (slope < 0.0) depth_m *= -plane.signed_distance_m(T_world_sensor.translation()) / slope;
    change.trust = range_trust(depth_m);
    cell.add(change.added, plane.normal(), change.trust);
  }

  /// Beside the limits of the range the noise of the depth is cut off on one side, which shifts what is seen there by
  /// up to its standard error: such points shape a plane only where there are no others.
  double range_trust(double depth_m) const {
    constexpr double kSigmas = 3.0;
    constexpr double kTrust = 1e-3;
    const double margin_m = kSigmas * config_.sensor.depth_sigma_per_m * depth_m * depth_m;
    const bool cut = depth_m < config_.sensor.min_range_m + margin_m || depth_m > config_.sensor.max_range_m - margin_m;
    return cut ? kTrust : 1.0;
  }

  void fit_normals(StageObserver* observer) {
    const StageScope scope(observer, Stage::kNormals);
    neighbourhoods_.begin(assigner_.changes().size());
    do_both(
        second_, [&] { fit_part(0); }, [&] { fit_part(1); });
    for (const CellChange& change : assigner_.changes()) planes_.attach(grid_, change.cell);
  }

  /// Of a part of the changes. They read what no normal changes, and their blocks are writable already.
  void fit_part(std::size_t part) {
    neighbourhoods_.gather(grid_, assigner_.changes(), part);
    for (std::uint32_t i = neighbourhoods_.first_of(part); i < neighbourhoods_.first_of(part + 1); ++i) {
      const CellRef ref = assigner_.changes()[i].cell;
      if (grid_.cell(ref).sums.count > config_.grid.density_threshold) {
        normals_[part].refresh(grid_, ref, neighbourhoods_.around(i));
      }
    }
  }

  void wear_away(std::span<const CellRef> worn, StageObserver* observer, ScanReport& report) {
    if (worn.empty()) return;
    const StageScope scope(observer, Stage::kWear);
    planes_.wear_away(grid_, worn);
    report.worn_cells = worn.size();
  }

  void trim_removals() {
    if (removed_.size() <= kKeptRemovals) return;
    const std::size_t surplus = removed_.size() - kKeptRemovals;
    removed_complete_since_ = removed_[surplus - 1].revision;
    removed_.erase(removed_.begin(), removed_.begin() + static_cast<std::ptrdiff_t>(surplus));
  }

  Neighbourhoods neighbourhoods_;
  MapperConfig config_;
  std::uint64_t epoch_;
  SecondThread* second_;
  std::uint64_t revision_ = 0;
  std::int64_t utime_ = 0;
  UncertainGrid grid_;
  Assigner assigner_;
  std::array<NormalEstimator, Neighbourhoods::kParts> normals_;
  LocalPlaneExtractor local_;
  PlaneMap planes_;
  Wear wear_;
  std::vector<std::shared_ptr<const PlaneRecord>> records_;
  std::vector<RemovedPlane> removed_;
  Pool<MapSnapshot> snapshots_;
  std::uint64_t removed_complete_since_ = 0;
};

Mapper::Mapper(const MapperConfig& config, std::uint64_t epoch, SecondThread* second)
    : impl_(std::make_unique<Impl>(config, epoch, second)) {}
Mapper::Mapper(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Expected<Mapper> Mapper::restore(const MapperConfig& config, const MapSnapshot& map, SecondThread* second) {
  if (auto whole = check_map(config, map); !whole) return tl::make_unexpected(whole.error());
  auto impl = std::make_unique<Impl>(config, map.epoch(), second);
  impl->restore(map);
  return Mapper(std::move(impl));
}

Mapper::~Mapper() = default;
Mapper::Mapper(Mapper&&) noexcept = default;
Mapper& Mapper::operator=(Mapper&&) noexcept = default;

ScanReport Mapper::integrate(const Scan& scan, const Eigen::Isometry3d& T_world_sensor, StageObserver* observer,
                             const std::optional<PoseCovariance>& pose_covariance) {
  return impl_->integrate(scan, ScanPose{T_world_sensor, utime_of(scan), pose_covariance}, observer);
}

Expected<AdditionReport> Mapper::add(const MapSnapshot& other, const std::optional<Eigen::Isometry3d>& T_ours_theirs,
                                     const std::function<void(double)>& progress) {
  if (auto whole = check_map(impl_->config(), other); !whole) return tl::make_unexpected(whole.error());
  return impl_->add(other, T_ours_theirs, progress);
}

std::shared_ptr<const MapSnapshot> Mapper::snapshot(StageObserver* observer) {
  return impl_->snapshot(observer);
}

}  // namespace planemap

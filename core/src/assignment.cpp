#include "planemap/assignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "near_cells.hpp"
#include "planemap/kinect_model.hpp"
#include "simd/select_kernels.hpp"

namespace planemap {

namespace {

/// Points beyond are not representable as cell indices; a map of that size is a mistake in the pose.
constexpr double kMaxCoordinateCells = 1e9;

/// The least float that is not below x, and the greatest that is not above it.
float not_below(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}
float not_above(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

/// Depths within the sensor's range, in units of the image.
struct DepthLimits {
  std::int32_t nearest;
  std::int32_t farthest;

  DepthLimits(const SensorConfig& sensor, double scale_m)
      : nearest(static_cast<std::int32_t>(std::clamp(std::floor(sensor.min_range_m / scale_m), 0.0, 65536.0))),
        farthest(static_cast<std::int32_t>(std::clamp(std::floor(sensor.max_range_m / scale_m) + 1.0, 0.0, 65535.0))) {
    while (nearest <= 65535 && nearest * scale_m < sensor.min_range_m) ++nearest;
    while (farthest >= 0 && farthest * scale_m > sensor.max_range_m) --farthest;
  }
};

}  // namespace

/// One scan on its way into the cells; what it needs stays for the next one.
class Assigner::Pass {
 public:
  Pass(const CoreConfig& core, const SensorConfig& sensor, const GridConfig& grid, SecondThread* second)
      : kernels_(simd::kernels(core.simd)), sensor_(sensor), second_(second), parts_{Part(grid), Part(grid)} {}

  PointCounts run(const UncertainGrid& grid, const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                  const DividingPlanes& planes);
  /// Writes what the scan adds, and makes its cells working ones.
  void collect(UncertainGrid& grid, const Eigen::Matrix3d& R_world_sensor, std::vector<CellChange>& changes);

 private:
  /// The scan is cut in two parts, each with sums of its own: two threads, or one after the other, come to the same.
  static constexpr std::size_t kParts = 2;
  struct alignas(64) Part {
    explicit Part(const GridConfig& grid) : near(grid) {}
    simd::PointChunk chunk;
    std::array<simd::Run, simd::kChunkPoints> runs{};
    simd::PieceCounts counts;
    NearCells near;
    std::array<std::uint32_t, simd::kChunkPoints + 1> begins{};
  };

  void place_sensor(const UncertainGrid& grid, const Eigen::Isometry3d& T_world_sensor, double focal_length_px,
                    const DividingPlanes& planes);
  void read(const UncertainGrid& grid, const DepthScan& scan, std::size_t number);
  void read(const UncertainGrid& grid, const PointScan& scan, std::size_t number);
  void assign_chunk(const UncertainGrid& grid, Part& part) const;
  void collect(UncertainGrid& grid, const Part& part, const Eigen::Matrix3d& R_squared,
               std::vector<CellChange>& changes) const;

  const simd::Kernels& kernels_;
  SensorConfig sensor_;
  SecondThread* second_;
  simd::Projection projection_;
  std::vector<float> ray_x_;
  std::array<Part, kParts> parts_;
};

PointCounts Assigner::Pass::run(const UncertainGrid& grid, const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                                const DividingPlanes& planes) {
  const auto* depth = std::get_if<DepthScan>(&scan);
  place_sensor(grid, T_world_sensor, depth != nullptr ? depth->intrinsics.fx : sensor_.focal_length_px, planes);
  if (depth != nullptr) {
    const PinholeIntrinsics& k = depth->intrinsics;
    ray_x_.resize(static_cast<std::size_t>(k.width));
    for (std::size_t u = 0; u < ray_x_.size(); ++u) {
      ray_x_[u] = static_cast<float>((static_cast<double>(u) - k.cx) / k.fx);
    }
  }
  const auto read_part = [&](std::size_t number) { std::visit([&](const auto& s) { read(grid, s, number); }, scan); };
  do_both(
      second_, [&] { read_part(0); }, [&] { read_part(1); });
  PointCounts found;
  for (const Part& part : parts_) {
    const simd::PieceCounts& c = part.counts;
    found += {c.mapped + c.no_return + c.out_of_range + c.invalid, c.mapped, c.no_return, c.out_of_range, c.invalid};
  }
  return found;
}

void Assigner::Pass::place_sensor(const UncertainGrid& grid, const Eigen::Isometry3d& T_world_sensor,
                                  double focal_length_px, const DividingPlanes& planes) {
  const KinectModel model(sensor_, focal_length_px);
  const double per_m = 1.0 / grid.cell_size_m();
  const Eigen::Vector3d sensor_cells = T_world_sensor.translation() * per_m;
  const bool is_in_this_world = sensor_cells.cwiseAbs().maxCoeff() < kMaxCoordinateCells;
  const Eigen::Vector3d corner = is_in_this_world ? Eigen::Vector3d(sensor_cells.array().floor()) : sensor_cells;
  for (Part& part : parts_) {
    part.near.begin(is_in_this_world ? CellIndex(corner.cast<int>()) : CellIndex::Zero(), T_world_sensor, planes);
    part.counts = {};
  }
  for (int w = 0; w < 3; ++w) {
    for (int k = 0; k < 3; ++k) {
      projection_.axis_cells[k][w] = static_cast<float>(T_world_sensor.linear()(w, k) * per_m);
    }
    projection_.origin_cells[w] = static_cast<float>(sensor_cells(w) - corner(w));
  }
  projection_.cell_size_m = static_cast<float>(grid.cell_size_m());
  projection_.limit_cells = is_in_this_world ? static_cast<float>(CellTable::kLimit - 1) : 0.0F;
  projection_.depth_factor2 = static_cast<float>(model.depth_factor() * model.depth_factor());
  projection_.lateral_factor2 = static_cast<float>(model.lateral_factor() * model.lateral_factor());
}

void Assigner::Pass::read(const UncertainGrid& grid, const DepthScan& scan, std::size_t number) {
  Part& part = parts_[number];
  const PinholeIntrinsics& k = scan.intrinsics;
  const auto width = static_cast<std::size_t>(k.width);
  const auto height = static_cast<std::size_t>(k.height);
  const DepthLimits limits(sensor_, scan.depth_scale_m);
  simd::DepthPiece piece;
  piece.depth_scale_m = static_cast<float>(scan.depth_scale_m);
  piece.nearest = limits.nearest;
  piece.farthest = limits.farthest;
  for (std::size_t v = height * number / kParts; v < height * (number + 1) / kParts; ++v) {
    piece.ray_y = static_cast<float>((static_cast<double>(v) - k.cy) / k.fy);
    for (std::size_t begin = 0; begin < width; begin += simd::kChunkPoints) {
      piece.depth = scan.depth.data() + v * width + begin;
      piece.ray_x = ray_x_.data() + begin;
      piece.size = std::min(simd::kChunkPoints, width - begin);
      kernels_.project_depth(projection_, piece, part.chunk, part.counts);
      assign_chunk(grid, part);
    }
  }
}

void Assigner::Pass::read(const UncertainGrid& grid, const PointScan& scan, std::size_t number) {
  Part& part = parts_[number];
  simd::CloudPiece piece;
  piece.min_range_m = not_below(sensor_.min_range_m);
  piece.max_range_m = not_above(sensor_.max_range_m);
  const std::size_t size = scan.xyz_m.size() / 3;
  const std::size_t end = size * (number + 1) / kParts;
  for (std::size_t begin = size * number / kParts; begin < end; begin += simd::kChunkPoints) {
    piece.xyz_m = scan.xyz_m.data() + 3 * begin;
    piece.sigma_m = scan.sigma_m.empty() ? nullptr : scan.sigma_m.data() + 3 * begin;
    piece.size = std::min(simd::kChunkPoints, end - begin);
    kernels_.project_cloud(projection_, piece, part.chunk, part.counts);
    assign_chunk(grid, part);
  }
}

void Assigner::Pass::assign_chunk(const UncertainGrid& grid, Part& part) const {
  constexpr std::size_t kPad = simd::PointChunk::kPad;
  simd::PointChunk& chunk = part.chunk;
  NearCells& near = part.near;
  const std::size_t count = kernels_.find_runs(chunk, part.begins.data());
  for (std::size_t i = 0; i < count; ++i) {
    simd::Run& run = part.runs[i];
    run = {part.begins[i], part.begins[i + 1]};
    const std::size_t at = kPad + run.begin;
    if (chunk.cell[0][at] == simd::PointChunk::kNoCell) continue;
    near.find_candidates(grid, {chunk.cell[0][at], chunk.cell[1][at], chunk.cell[2][at]}, run);
  }
  kernels_.assign(chunk, part.runs.data(), count, near.candidates());
  if (near.has_dividers()) kernels_.divide(chunk, near.accumulators(), near.dividers());
  kernels_.accumulate(chunk, near.accumulators());
}

void Assigner::Pass::collect(UncertainGrid& grid, const Eigen::Matrix3d& R_world_sensor,
                             std::vector<CellChange>& changes) {
  const Eigen::Matrix3d R_squared = R_world_sensor.cwiseAbs2();
  for (Part& part : parts_) {
    part.near.make_noted(grid);
    collect(grid, part, R_squared, changes);
  }
}

void Assigner::Pass::collect(UncertainGrid& grid, const Part& part, const Eigen::Matrix3d& R_squared,
                             std::vector<CellChange>& changes) const {
  const double size_m = grid.cell_size_m();
  const double size2 = size_m * size_m;
  for (std::size_t target = 0; target < part.near.size(); ++target) {
    const simd::Accumulator& accumulator = part.near.accumulator(target);
    if (accumulator.count == 0) continue;
    const CellRef ref = part.near.cell(target);
    std::uint32_t& working = grid.writable(ref).working;
    if (working == Cell::kNotWorking) {
      working = static_cast<std::uint32_t>(changes.size());
      changes.emplace_back().cell = ref;
    }
    ScanSums& added = changes[working].added;
    std::array<double, simd::kSumCount> sum;
    std::copy(std::begin(accumulator.sums), std::end(accumulator.sums), sum.begin());
    added.points.weight += accumulator.count;
    added.points.first += size_m * Eigen::Vector3d(sum[0], sum[1], sum[2]);
    for (std::size_t i = 0; i < 6; ++i) added.points.second.e[i] += size2 * sum[3 + i];
    added.error_m2 += R_squared * Eigen::Vector3d(sum[9], sum[10], sum[11]);
  }
}

Assigner::Assigner(const CoreConfig& core, const SensorConfig& sensor, const GridConfig& grid, SecondThread* second)
    : pass_(std::make_unique<Pass>(core, sensor, grid, second)) {}
Assigner::~Assigner() = default;

PointCounts Assigner::assign(UncertainGrid& grid, const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                             const DividingPlanes& planes) {
  changes_.clear();
  const PointCounts counts = pass_->run(grid, scan, T_world_sensor, planes);
  pass_->collect(grid, T_world_sensor.linear(), changes_);
  for (CellChange& change : changes_) {
    // One view direction for a cell and scan: it turns by a fraction of a degree within the cell.
    const Eigen::Vector3d mean_m = grid.geometric_centre_m(change.cell) + change.added.points.mean();
    const Eigen::Vector3d view = (T_world_sensor.translation() - mean_m).normalized() * change.added.count();
    change.added.view = view.cast<float>();
  }
  return counts;
}

void Assigner::finish(UncertainGrid& grid) {
  for (const CellChange& change : changes_) grid.writable(change.cell).working = Cell::kNotWorking;
}

}  // namespace planemap

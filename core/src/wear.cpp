#include "planemap/wear.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planemap/kinect_model.hpp"

namespace planemap {

namespace {

/// Blocks of the box about the view that are tried for a scan; of a larger view each scan takes a share, in turn. The
/// view of a Kinect in blocks of 64 cm has about 1,000.
constexpr std::uint32_t kTriedBlocks = 4096;

/// Blocks farther away than this, or farther to the side, are not tried: so their number stays one.
constexpr double kFarthestBlocks = 200.0;
constexpr double kWidestTangent = 2.0;

/// A look counts for the time since the last one, but for no more than this: a few looks must agree.
constexpr std::int64_t kLongestLook_us = 250'000;

/// Parts of the time after which a cell goes; so many make it go. They fit in a byte.
constexpr std::uint32_t kParts = 200;

}  // namespace

Wear::Wear(const WearConfig& config, const SensorConfig& sensor, double cell_size_m)
    : config_(config),
      sensor_(sensor),
      cell_size_m_(cell_size_m),
      half_m_(static_cast<float>((0.5 + config.clearance_cells) * cell_size_m)),
      part_us_(std::max<std::int64_t>(1, std::llround(1e6 * config.after_s / kParts))),
      longest_look_(static_cast<std::uint32_t>(std::max<std::int64_t>(1, kLongestLook_us / part_us_))) {}

std::span<const CellRef> Wear::look(const UncertainGrid& grid, const Scan& scan,
                                    const Eigen::Isometry3d& T_world_sensor, std::span<const CellChange> changes) {
  found_.clear();
  const std::uint32_t elapsed = elapsed_parts(utime_of(scan));
  page_of_.resize(grid.block_count(), 0);
  for (const CellChange& change : changes) forget(grid, change.cell);
  if (elapsed == 0) return found_;

  tiles_.read(scan);
  if (tiles_.seen().isEmpty()) return found_;
  const auto* depth = std::get_if<DepthScan>(&scan);
  const KinectModel model(sensor_, depth != nullptr ? depth->intrinsics.fx : sensor_.focal_length_px);
  depth_factor_ = static_cast<float>(model.depth_factor());
  const View view = view_of(T_world_sensor);
  const auto nx = static_cast<std::uint32_t>(view.blocks.x());
  const auto ny = static_cast<std::uint32_t>(view.blocks.y());
  const std::uint32_t tried = nx * ny * static_cast<std::uint32_t>(view.blocks.z());
  const std::uint32_t shares = tried / kTriedBlocks + 1;
  const std::uint32_t credit = std::min(longest_look_, elapsed * shares);
  for (std::uint32_t i = scans_++ % shares; i < tried; i += shares) {
    const BlockIndex step(static_cast<int>(i % nx), static_cast<int>(i / nx % ny), static_cast<int>(i / nx / ny));
    const BlockIndex index = view.first_block + step;
    if (!in_view(view, index)) continue;
    if (const auto slot = grid.find_block(index)) look_at(grid, *slot, view, credit);
  }
  return found_;
}

/// Time since the last scan; what is left of a part is kept for the next time.
std::uint32_t Wear::elapsed_parts(std::int64_t utime) {
  if (utime_ == 0 || utime < utime_) {  // a clock that was set back tells no time
    utime_ = utime;
    return 0;
  }
  const std::int64_t elapsed = (utime - utime_) / part_us_;
  utime_ += elapsed * part_us_;
  return static_cast<std::uint32_t>(std::min<std::int64_t>(elapsed, longest_look_));
}

Wear::View Wear::view_of(const Eigen::Isometry3d& T_world_sensor) const {
  View view;
  view.T_sensor_world = T_world_sensor.inverse();
  const double block_m = kBlockEdge * cell_size_m_;
  // Nothing is seen through behind the farthest surface.
  view.range_m = std::min({static_cast<double>(tiles_.farthest_m()), sensor_.max_range_m, kFarthestBlocks * block_m});
  const auto tangent = [](double t) { return std::clamp(t, -kWidestTangent, kWidestTangent); };
  const double left = tangent((tiles_.seen().min().x() - tiles_.cx()) / tiles_.fx());
  const double right = tangent((tiles_.seen().max().x() + 1 - tiles_.cx()) / tiles_.fx());
  const double up = tangent((tiles_.seen().min().y() - tiles_.cy()) / tiles_.fy());
  const double down = tangent((tiles_.seen().max().y() + 1 - tiles_.cy()) / tiles_.fy());
  view.sides = {Eigen::Vector3d(-1.0, 0.0, left).normalized(), Eigen::Vector3d(1.0, 0.0, -right).normalized(),
                Eigen::Vector3d(0.0, -1.0, up).normalized(), Eigen::Vector3d(0.0, 1.0, -down).normalized()};
  Eigen::AlignedBox3d box(T_world_sensor.translation());
  for (const double x : {left, right}) {
    for (const double y : {up, down}) box.extend(T_world_sensor * (view.range_m * Eigen::Vector3d(x, y, 1.0)));
  }
  const Eigen::Array3d first = (box.min() / block_m).array().floor();
  const Eigen::Array3d last = (box.max() / block_m).array().floor();
  // A pose so far away that its blocks have no numbers sees nothing.
  constexpr double kLimit = 1e8;
  const bool is_in_this_world = first.abs().maxCoeff() < kLimit && last.abs().maxCoeff() < kLimit;
  view.first_block = is_in_this_world ? Eigen::Vector3i(first.cast<int>()) : Eigen::Vector3i::Zero();
  view.blocks = is_in_this_world ? Eigen::Vector3i((last - first).cast<int>() + 1) : Eigen::Vector3i::Zero();
  return view;
}

bool Wear::in_view(const View& view, const BlockIndex& index) const {
  const double block_m = kBlockEdge * cell_size_m_;
  const double radius_m = 0.5 * std::sqrt(3.0) * block_m;
  const Eigen::Vector3d centre_m = (index.cast<double>().array() + 0.5).matrix() * block_m;
  const Eigen::Vector3d p_sensor_m = view.T_sensor_world * centre_m;
  if (p_sensor_m.z() < -radius_m || p_sensor_m.z() > view.range_m + radius_m) return false;
  return std::all_of(view.sides.begin(), view.sides.end(),
                     [&](const Eigen::Vector3d& side) { return side.dot(p_sensor_m) < radius_m; });
}

void Wear::look_at(const UncertainGrid& grid, std::uint32_t slot, const View& view, std::uint32_t credit) {
  const Block& block = grid.block(slot);
  const Eigen::Vector3f first =
      (view.T_sensor_world * grid.geometric_centre_m(cell_at(block.index(), 0))).cast<float>();
  const Eigen::Matrix3f axes = view.T_sensor_world.linear().cast<float>();
  const Eigen::Matrix3f step = static_cast<float>(cell_size_m_) * axes;
  for (std::uint32_t ordinal = 0; ordinal < block.size(); ++ordinal) {
    const int place = block.place(ordinal);
    const Eigen::Vector3f p = first + step * cell_at(BlockIndex::Zero(), place).cast<float>();
    if (!is_before_surface(p)) continue;
    const Cell& first_cell = block.cell(ordinal);
    if (first_cell.is_second) continue;  // it goes with the other cell of its place
    const bool has_second = first_cell.second != Cell::kNoSecond;
    const Cell& second_cell = has_second ? block.cell(first_cell.second) : first_cell;
    const Cell& cell = first_cell.sums.count > 0.0 ? first_cell : second_cell;
    if (!(cell.sums.count > 0.0)) continue;
    if (first_cell.working != Cell::kNotWorking || second_cell.working != Cell::kNotWorking) continue;  // just seen
    if (!is_seen_through(cell, p, axes)) continue;
    std::uint8_t& parts = seen_through(slot, place);
    const std::uint32_t sum = parts + credit;
    parts = static_cast<std::uint8_t>(sum < kParts ? sum : 0);
    if (sum < kParts) continue;
    found_.push_back({slot, ordinal});
    if (has_second) found_.push_back({slot, first_cell.second});
  }
}

/// Most cells are on what is seen, or behind it: the tile that their middle is in tells.
bool Wear::is_before_surface(const Eigen::Vector3f& p) const {
  if (p.z() < static_cast<float>(sensor_.min_range_m)) return false;
  const Eigen::Vector2f uv = tiles_.place_of(p);
  if (!tiles_.contains(uv)) return false;
  const int u = static_cast<int>(uv.x());
  const int v = static_cast<int>(uv.y());
  return !tiles_.is_silent(u, v) && tiles_.nearest_m(u, v) > p.z() + 0.5F * half_m_;
}

/// The tiles that a cube covers, u and v; empty where the image cuts it off, or it reaches to the sensor.
Eigen::AlignedBox2i Wear::outline(const Eigen::Vector3f& p, const Eigen::Matrix3f& axes, float half_m) const {
  Eigen::AlignedBox2f box;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f signs((corner & 1) != 0 ? half_m : -half_m, (corner & 2) != 0 ? half_m : -half_m,
                                (corner & 4) != 0 ? half_m : -half_m);
    const Eigen::Vector3f q = p + axes * signs;
    if (!(q.z() > 0.0F)) return {};
    box.extend(tiles_.place_of(q));
  }
  if (!tiles_.contains(box.min()) || !tiles_.contains(box.max())) return {};
  return {box.min().cast<int>(), box.max().cast<int>()};
}

bool Wear::is_seen_through(const Cell& cell, const Eigen::Vector3f& p, const Eigen::Matrix3f& axes) const {
  // A tile's middle ray stands for all of its rays: the cube is larger by half a tile.
  const float half_m = half_m_ + 0.5F * p.z() / static_cast<float>(tiles_.fx());
  const Eigen::AlignedBox2i covered = outline(p, axes, half_m);
  if (covered.isEmpty()) return false;
  const Eigen::Vector3f middle = axes.transpose() * p;  // from the sensor, along the cube's axes
  const auto cell_variance_m2 = cell.sums.error_m2.sum() / static_cast<float>(cell.sums.count);
  int crossing = 0;
  int silent = 0;
  for (int v = covered.min().y(); v <= covered.max().y(); ++v) {
    for (int u = covered.min().x(); u <= covered.max().x(); ++u) {
      // Where the ray is between the two faces across each of the cube's axes; its depth is its own length along z.
      const Eigen::Array3f along = (axes.transpose() * tiles_.ray_of(u, v)).array();
      const Eigen::Array3f first = (middle.array() - half_m) / along;
      const Eigen::Array3f last = (middle.array() + half_m) / along;
      const float leaves_m = first.max(last).minCoeff();
      if (!(first.min(last).maxCoeff() < leaves_m)) continue;
      ++crossing;
      silent += tiles_.is_silent(u, v) ? 1 : 0;
      if (!is_behind(tiles_.nearest_m(u, v), leaves_m, cell_variance_m2)) return false;
    }
  }
  // Without a return the surface itself may be what the ray met: only one that the sensor looks in the face would have
  // answered in most of the tiles.
  if (silent == 0) return true;
  return 4 * silent <= crossing && cell.has_normal() && -(axes * cell.normal).dot(p) > 0.5F * p.norm();
}

/// Whether what was measured lies behind a depth by more than the errors of the measurement and the cell.
bool Wear::is_behind(float nearest_m, float depth_m, float cell_variance_m2) const {
  if (std::isinf(nearest_m)) return true;
  const float sigma_m = depth_factor_ * nearest_m * nearest_m;
  const float least_m = static_cast<float>(config_.sigmas) * std::sqrt(sigma_m * sigma_m + cell_variance_m2);
  return nearest_m - depth_m > least_m;
}

std::uint8_t& Wear::seen_through(std::uint32_t slot, int place) {
  std::uint32_t& page = page_of_[slot];
  if (page == 0) {
    pages_.emplace_back().fill(0);
    page = static_cast<std::uint32_t>(pages_.size());
  }
  return pages_[page - 1][static_cast<std::size_t>(place)];
}

void Wear::forget(const UncertainGrid& grid, CellRef ref) {
  if (page_of_[ref.block] == 0) return;
  seen_through(ref.block, grid.block(ref.block).place(ref.ordinal)) = 0;
}

}  // namespace planemap

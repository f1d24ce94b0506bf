#include "map_addition.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "sort_unique.hpp"

namespace planemap {

namespace {

/// About what a scan touches.
constexpr std::size_t kBatchCells = 4096;

Eigen::Matrix3d outer(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a * b.transpose();
}

Symmetric3 symmetric(const Eigen::Matrix3d& m) {
  return {{m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)}};
}

/// Moments of points R p + s where those of p are given.
Moments turned(const Moments& m, const Eigen::Matrix3d& R, const Eigen::Vector3d& s) {
  const Eigen::Vector3d first = R * m.first;
  const Eigen::Matrix3d second =
      R * m.second.matrix() * R.transpose() + outer(first, s) + outer(s, first) + m.weight * outer(s, s);
  return {m.weight, first + m.weight * s, symmetric(second)};
}

/// The plain second moment about the geometric centre; off the diagonal as the evidence has it.
Symmetric3 second_moment_of(const Cell& cell) {
  const Eigen::Vector3d mean = cell.sums.mean_m();
  Eigen::Matrix3d spread = (cell.sums.square_m2.cast<double>() / cell.sums.count - mean.cwiseAbs2()).asDiagonal();
  if (cell.has_evidence()) spread = cell.evidence.unpacked().covariance();
  return symmetric(cell.sums.count * (spread + outer(mean, mean)));
}

void add_sums(CellSums& to, const CellSums& sums) {
  to.count += sums.count;
  to.first_m += sums.first_m;
  to.square_m2 += sums.square_m2;
  to.error_m2 += sums.error_m2;
  to.view += sums.view;
}

/// How alike the normals of two cells are: their cosine; of cells without normals 0.
double alike(const Cell& a, const Cell& b) {
  return static_cast<double>(a.normal.dot(b.normal));
}

/// Of the cells at a place, the one whose surface a cell of the other map shows.
CellRef counterpart(UncertainGrid& grid, CellRef first, const Cell& cell) {
  if (cell.is_second && grid.cell(first).second == Cell::kNoSecond) return grid.find_or_add_second(first);
  const auto second = grid.sibling(first);
  if (!second) return first;
  const double to_first = alike(grid.cell(first), cell);
  const double to_second = alike(grid.cell(*second), cell);
  if (to_first == to_second) return cell.is_second ? *second : first;
  return to_first > to_second ? first : *second;
}

}  // namespace

Cell moved(const Cell& cell, const Eigen::Vector3d& centre_m, const Eigen::Isometry3d& T,
           const Eigen::Vector3d& to_centre_m) {
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d s = T * centre_m - to_centre_m;
  Cell out = cell;
  const Moments points = turned({cell.sums.count, cell.sums.first_m, second_moment_of(cell)}, R, s);
  out.sums.first_m = points.first;
  out.sums.square_m2 = Eigen::Vector3d(points.second.e[0], points.second.e[3], points.second.e[5]).cast<float>();
  out.sums.error_m2 = (R.cwiseAbs2() * cell.sums.error_m2.cast<double>()).cast<float>();
  out.sums.view = (R * cell.sums.view.cast<double>()).cast<float>();
  out.evidence = {};
  if (cell.has_evidence()) out.evidence.add(turned(cell.evidence.unpacked(), R, s), 1.0);
  out.normal = (R * cell.normal.cast<double>()).cast<float>();
  return out;
}

MapAddition::MapAddition(const MapSnapshot& other, const std::optional<Eigen::Isometry3d>& T_ours_theirs)
    : other_(other), T_(T_ours_theirs) {
  for (const auto& record : other.planes()) records_.emplace(record->id, record.get());
}

void MapAddition::add_cells(UncertainGrid& grid, PlaneMap& planes) {
  added_.reserve(other_.cell_count());
  for (const auto& block : other_.blocks()) {
    for (std::size_t i = 0; i < block->size(); ++i) {
      if (block->cell(i).sums.count > 0.0) add_cell(grid, planes, *block, i);
    }
  }
  std::sort(added_.begin(), added_.end());
  cells_.reserve(added_.size());
  for (const Added& added : added_) cells_.push_back(added.ours);
  sort_unique(cells_);
}

void MapAddition::add_cell(UncertainGrid& grid, PlaneMap& planes, const Block& block, std::size_t ordinal) {
  const Cell& theirs = block.cell(ordinal);
  CellIndex index = block.cell_index(ordinal);
  Cell cell = theirs;
  if (T_) {
    const Eigen::Vector3d centre_m = grid.geometric_centre_m(index);
    index = grid.index_of(*T_ * (centre_m + theirs.sums.mean_m()));
    cell = moved(theirs, centre_m, *T_, grid.geometric_centre_m(index));
  }
  const CellRef ref = counterpart(grid, grid.find_or_add(index), cell);
  planes.detach(grid, ref);
  Cell& ours = grid.writable(ref);
  add_sums(ours.sums, cell.sums);
  if (cell.has_evidence()) ours.evidence.add(cell.evidence.unpacked(), 1.0);
  ours.evidence_count += cell.evidence_count;
  planes.attach(grid, ref);
  added_.push_back({ref, theirs.plane});
}

std::size_t MapAddition::whole_batches() const {
  return (cells_.size() + kBatchCells - 1) / kBatchCells;
}

void MapAddition::begin_batch(std::size_t batch, UncertainGrid& grid, std::vector<CellChange>& changes) const {
  // The second time all batches begin, and the first one ends, half a batch earlier.
  const bool again = batch >= whole_batches();
  const std::size_t earlier = again ? kBatchCells / 2 : 0;
  const std::size_t end = ((again ? batch - whole_batches() : batch) + 1) * kBatchCells - earlier;
  const std::size_t begin = end < kBatchCells ? 0 : end - kBatchCells;
  changes.clear();
  for (std::size_t i = std::min(begin, cells_.size()); i < std::min(end, cells_.size()); ++i) {
    grid.writable(cells_[i]).working = static_cast<std::uint32_t>(changes.size());
    changes.push_back({cells_[i], {}, 1.0});
  }
}

ScanPose MapAddition::pose_of(const UncertainGrid& grid, std::span<const CellChange> changes) const {
  constexpr double kRange_m = 2.0;  // from which a Kinect sees most of what it maps
  ScanPose pose;
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d view = Eigen::Vector3d::Zero();
  std::int64_t utime = std::numeric_limits<std::int64_t>::min();
  for (const CellChange& change : changes) {
    middle_m += grid.middle_m(change.cell) / static_cast<double>(changes.size());
    view += grid.cell(change.cell).sums.view.cast<double>();
    const auto theirs = std::lower_bound(added_.begin(), added_.end(), Added{change.cell, kNoSlot});
    if (theirs == added_.end() || theirs->ours != change.cell) continue;
    const auto record = records_.find(theirs->theirs);
    if (record != records_.end()) utime = std::max(utime, record->second->last_seen_utime);
  }
  pose.T_world_sensor.translation() = middle_m + kRange_m * view.stableNormalized();
  pose.utime = utime == std::numeric_limits<std::int64_t>::min() ? other_.utime() : utime;
  if (other_.state().poses_err) pose.covariance = other_.state().last_pose;
  return pose;
}

void MapAddition::note_times(const UncertainGrid& grid, PlaneMap& planes) const {
  // Of each of their planes, the one of ours that most of its cells are in.
  std::map<std::pair<PlaneSlot, PlaneSlot>, std::size_t> shared;  // theirs, ours
  for (const Added& added : added_) {
    const PlaneSlot ours = grid.cell(added.ours).plane;
    if (added.theirs != kNoSlot && ours != kNoSlot) ++shared[{added.theirs, ours}];
  }
  std::map<PlaneSlot, std::pair<std::size_t, PlaneSlot>> most;
  for (const auto& [pair, cells] : shared) most[pair.first] = std::max(most[pair.first], std::pair(cells, pair.second));
  for (const auto& [theirs, best] : most) {
    const auto record = records_.find(theirs);
    if (record != records_.end()) planes.note_seen(best.second, record->second->first_seen_utime);
  }
}

}  // namespace planemap

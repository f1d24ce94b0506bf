#include "near_cells.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "planemap/expected_distance.hpp"

namespace planemap {

void NearCells::begin(const CellIndex& base, const Eigen::Isometry3d& T_world_sensor, const DividingPlanes& planes) {
  frame_ = {base, T_world_sensor, config_.cell_size_m, planes.pose_variance_m2};
  planes_ = planes;
  dividers_.clear();
  table_.clear();
  cells_.clear();
  noted_.clear();
  candidates_.clear();
}

void NearCells::find_candidates(const UncertainGrid& grid, const CellIndex& cell, simd::Run& run) {
  std::uint32_t number = table_(cell.x(), cell.y(), cell.z());
  if (number == kNone) {
    const auto ref = grid.find(frame_.base + cell);
    number = ref ? number_of(grid, *ref, cell) : note(cell, kNone);
  }
  if (cells_[number].candidate_count == 0) list_candidates(grid, number, cell);
  run.first_candidate = cells_[number].first_candidate;
  run.candidate_count = cells_[number].candidate_count;
  std::copy_n(accumulators_[number].centre_cells, 3, run.centre_cells);
}

std::uint32_t NearCells::number_of(const UncertainGrid& grid, CellRef ref, const CellIndex& cell) {
  if (const std::uint32_t known = table_(cell.x(), cell.y(), cell.z()); known != kNone) return known;
  const std::uint32_t number = add(grid, ref, cell);
  table_(cell.x(), cell.y(), cell.z()) = number;
  if (const std::uint16_t second_ordinal = grid.cell(ref).second; second_ordinal != Cell::kNoSecond) {
    const CellRef second{ref.block, second_ordinal};
    const std::uint32_t other = add(grid, second, cell);
    pair(number, planes_.of(grid.cell(ref).plane), other, planes_.of(grid.cell(second).plane));
  }
  return number;
}

/// Tells the points of two cells at one place apart; where no plane of theirs is known, Eq. 7 alone does.
void NearCells::pair(std::uint32_t number, const Plane* plane, std::uint32_t other, const Plane* other_plane) {
  cells_[number].second = other;
  if (plane == nullptr && other_plane == nullptr) return;
  accumulators_[number].divider = accumulators_[other].divider = static_cast<std::int32_t>(dividers_.size());
  dividers_.push_back({{static_cast<std::int32_t>(number), static_cast<std::int32_t>(other)},
                       {scan_plane(plane, frame_), scan_plane(other_plane, frame_)}});
}

std::uint32_t NearCells::add(const CellIndex& cell) {
  const auto number = static_cast<std::uint32_t>(cells_.size());
  cells_.emplace_back();
  if (accumulators_.size() < cells_.size()) accumulators_.resize(2 * cells_.size());
  simd::Accumulator& accumulator = accumulators_[number];
  accumulator = {};
  for (int w = 0; w < 3; ++w) accumulator.centre_cells[w] = static_cast<float>(cell(w)) + 0.5F;
  return number;
}

std::uint32_t NearCells::add(const UncertainGrid& grid, CellRef ref, const CellIndex& cell) {
  const std::uint32_t number = add(cell);
  NearCell& near = cells_[number];
  near.ref = ref;
  const CellSums& sums = grid.cell(ref).sums;
  near.has_points = sums.count > 0.0;
  if (!near.has_points) return number;
  const double per_m = 1.0 / grid.cell_size_m();
  const CentreStatistics statistics{sums.count, sums.first_m, sums.error_m2.cast<double>()};
  near.centre_cells = expected_centre(statistics) * per_m;
  if (config_.clamp_centres) near.centre_cells = near.centre_cells.cwiseMax(-0.5).cwiseMin(0.5);
  near.variance_cells2 = centre_variance(statistics) * per_m * per_m;
  near.view = sums.view;
  return number;
}

std::uint32_t NearCells::note(const CellIndex& cell, std::uint32_t first) {
  const std::uint32_t number = add(cell);
  if (first == kNone) table_(cell.x(), cell.y(), cell.z()) = number;
  noted_.push_back({number, first, cell});
  return number;
}

void NearCells::make_noted(UncertainGrid& grid) {
  for (const Noted& noted : noted_) {
    cells_[noted.number].ref = noted.first == kNone ? grid.find_or_add(frame_.base + noted.cell)
                                                    : grid.find_or_add_second(cells_[noted.first].ref);
  }
}

void NearCells::list_candidates(const UncertainGrid& grid, std::uint32_t number, const CellIndex& cell) {
  rivals_.clear();
  const std::uint32_t second = cells_[number].second;
  if (cells_[number].has_points || (second != kNone && cells_[second].has_points)) {
    gather(grid, number, cell);
    drop_losers();
  } else {
    rivals_.push_back({Eigen::Vector3d::Zero(), 0.0, number});
  }
  cells_[number].first_candidate = static_cast<std::uint32_t>(candidates_.size());
  cells_[number].candidate_count = static_cast<std::uint32_t>(rivals_.size());
  for (const Rival& rival : rivals_) {
    const Eigen::Vector3f slope = (-2.0 * rival.place_cells).cast<float>();
    candidates_.push_back({{slope.x(), slope.y(), slope.z()},
                           static_cast<float>(rival.bias_cells2),
                           static_cast<std::int32_t>(rival.target)});
  }
}

void NearCells::gather(const UncertainGrid& grid, std::uint32_t number, const CellIndex& cell) {
  const Eigen::Vector3f view =
      (frame_.T_world_sensor.translation() - grid.geometric_centre_m(frame_.base + cell)).cast<float>();
  open_second(grid, number, cell, view);
  grid.for_each_neighbour(cells_[number].ref, 1, [&](CellRef other_ref, const CellIndex& step) {
    std::uint32_t target = number_of(grid, other_ref, cell + step);
    if (grid.cell(other_ref).is_second) target = cells_[target].second;
    const NearCell& other = cells_[target];
    if (!other.has_points) return;
    // The faces of a thin wall: a cell that was seen from the other side does not attract these points.
    if (config_.view_side && target != number && other.view.dot(view) < 0.0F) return;
    const Eigen::Vector3d place = other.centre_cells + step.cast<double>();
    rivals_.push_back({place, place.squaredNorm() + other.variance_cells2, target});
  });
}

/// Both faces of a sheet may lie in one cell: what is seen of it from behind is of its other face.
void NearCells::open_second(const UncertainGrid& grid, std::uint32_t number, const CellIndex& cell,
                            const Eigen::Vector3f& view) {
  if (!config_.second_surfaces || !config_.view_side || cells_[number].second != kNone) return;
  if (!cells_[number].has_points || cells_[number].view.dot(view) >= 0.0F) return;
  const Plane* plane = planes_.of(grid.cell(cells_[number].ref).plane);
  if (plane == nullptr || plane->signed_distance_m(frame_.T_world_sensor.translation()) >= 0.0) return;
  pair(number, plane, note(cell, number), nullptr);
}

void NearCells::drop_losers() {
  // The difference of two rivals' distances is affine in the point: who loses to another on all eight corners of the
  // cell loses everywhere in it. The other is the winner at the middle, which strikes out nearly all that can be.
  const auto winner = std::min_element(rivals_.begin(), rivals_.end(),
                                       [](const Rival& a, const Rival& b) { return a.bias_cells2 < b.bias_cells2; });
  std::iter_swap(rivals_.begin(), winner);
  const Rival first = rivals_.front();
  const auto loses = [&](const Rival& rival) {
    // distance(rival) - distance(first) is least where each coordinate pulls hardest towards the rival.
    const double pull = (rival.place_cells - first.place_cells).lpNorm<1>();
    return rival.bias_cells2 - first.bias_cells2 - pull > 0.0;
  };
  rivals_.erase(std::remove_if(rivals_.begin() + 1, rivals_.end(), loses), rivals_.end());
}

}  // namespace planemap

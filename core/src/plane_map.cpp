#include "planemap/plane_map.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "angles.hpp"

namespace planemap {

namespace {

/// What a pose's error adds to the bands about planes. Where poses err by more than the distance at which planes are
/// told apart, no band holds a surface together without taking in the cells of others. A filter that drifts says so of
/// itself in the end, though scans that follow each other fit well.
double band_variance_m2(const PoseCovariance& pose, double plane_offset_m) {
  return std::min(point_variance_m2(pose), plane_offset_m * plane_offset_m);
}

}  // namespace

PlaneMap::PlaneMap(const GridConfig& grid, const PlaneConfig& planes, const PoseErrorConfig& pose_error)
    : grid_config_(grid),
      config_(planes),
      pose_error_(pose_error),
      poses_err_(pose_error.any()),
      last_pose_(configured_covariance(pose_error)),
      pose_variance_m2_(band_variance_m2(last_pose_, planes.plane_offset_m)),
      max_angle_rad_(planes.normal_angle_deg * kRadPerDeg),
      alike_cosine_(std::cos(planes.normal_angle_deg * kRadPerDeg)),
      core_cosine_(std::cos(planes.core_angle_deg * kRadPerDeg)),
      states_(1),
      coarse_(0.5 * std::max(planes.bridge_gap_m, 4.0 * grid.cell_size_m)) {}

void PlaneMap::mark_changed(PlaneSlot slot) {
  State& plane = state(slot);
  if (!std::exchange(plane.touched, true)) touched_.push_back(slot);
  if (!std::exchange(plane.dirty, true)) dirty_.push_back(slot);
}

void PlaneMap::refit(PlaneSlot slot) {
  if (const auto fit = state(slot).statistics.fit(config_.pooled_refit)) state(slot).fit = *fit;
}

bool PlaneMap::agree(const PlaneStatistics& a, const PlaneFit& fit_a, const PlaneStatistics& b, const PlaneFit& fit_b,
                     double max_angle_rad, double max_offset_m) const {
  if (expected_squared_distance(fit_a.plane.normal(), fit_a.deviation_rad, fit_b.plane.normal(), fit_b.deviation_rad) >=
      squared_chord(max_angle_rad)) {
    return false;
  }
  if (!config_.offset_test) return true;
  if (!(a.weight() > 0.0 && b.weight() > 0.0)) return false;
  if (are_creased(a, fit_a, b, fit_b)) return false;
  // How far the smaller one's evidence lies from the larger one's plane, beyond what it scatters about its own.
  const bool a_is_smaller = a.weight() < b.weight();
  const PlaneStatistics& smaller = a_is_smaller ? a : b;
  const PlaneFit& own = a_is_smaller ? fit_a : fit_b;
  const PlaneFit& larger = a_is_smaller ? fit_b : fit_a;
  const double excess_m2 = smaller.mean_square_distance_m2(larger.plane) - own.residual_m2;
  return excess_m2 < max_offset_m * max_offset_m;
}

/// Adds the planes of cells to touching_.
void PlaneMap::note_touching(const UncertainGrid& grid, std::span<const CellRef> cells) {
  for (const CellRef ref : cells) {
    const PlaneSlot slot = grid.cell(ref).plane;
    if (slot == kNoSlot || noted_in_[slot] == search_) continue;
    noted_in_[slot] = search_;
    touching_.push_back(slot);
  }
}

void PlaneMap::begin_touching() {
  touching_.clear();
  noted_in_.resize(states_.size(), 0);
  ++search_;
}

PlaneSlot PlaneMap::absorb_into(UncertainGrid& grid, const LocalPlane& local, const Neighbourhoods& neighbourhoods,
                                GlobalReport& report) {
  begin_touching();
  for (const CellRef ref : local.cells) note_touching(grid, neighbourhoods.around(grid.cell(ref).working));
  std::vector<PlaneSlot>& similar = touching_;
  std::erase_if(similar, [&](PlaneSlot slot) {
    const State& global = state(slot);
    return !agree(local.statistics, local.fit, global.statistics, global.fit, max_angle_rad_, config_.plane_offset_m);
  });
  if (similar.empty()) return kNoSlot;
  // The best-supported one decides; others merge with it only if they agree with it themselves.
  std::sort(similar.begin(), similar.end(), [&](PlaneSlot a, PlaneSlot b) {
    const std::size_t cells_a = state(a).statistics.cell_count();
    const std::size_t cells_b = state(b).statistics.cell_count();
    return cells_a != cells_b ? cells_a > cells_b : a < b;
  });
  PlaneSlot target = similar.front();
  for (std::size_t i = 1; i < similar.size(); ++i) {
    target = merge_if_agreed(grid, target, similar[i], report);
  }
  return target;
}

PlaneSlot PlaneMap::merge_if_agreed(UncertainGrid& grid, PlaneSlot slot, PlaneSlot other, GlobalReport& report) {
  const State& a = state(slot);
  const State& b = state(other);
  if (!agree(a.statistics, a.fit, b.statistics, b.fit, max_angle_rad_, config_.plane_offset_m)) return slot;
  ++report.merged_planes;
  return merge_planes(grid, slot, other);
}

PlaneSlot PlaneMap::merge_planes(UncertainGrid& grid, PlaneSlot a, PlaneSlot b) {
  const PlaneSlot survivor = std::min(a, b);  // the oldest id lives on
  const PlaneSlot gone = std::max(a, b);
  State& into = state(survivor);
  State& from = state(gone);
  for (const CellRef ref : from.cells) {
    if (grid.cell(ref).plane != gone) continue;
    grid.writable(ref).plane = survivor;
    into.cells.push_back(ref);
    const Eigen::Vector3d centre_m = grid.geometric_centre_m(ref);
    coarse_.remove(centre_m, gone);
    coarse_.add(centre_m, survivor);
  }
  into.statistics.add(from.statistics);
  into.pose_evidence.add(from.pose_evidence, from.statistics.origin_m() - into.statistics.origin_m(), pose_error_);
  into.worn_cells += from.worn_cells;
  into.first_seen_utime = std::min(into.first_seen_utime, from.first_seen_utime);
  into.last_seen_utime = std::max(into.last_seen_utime, from.last_seen_utime);
  into.merged.push_back(id_of(gone));
  into.merged.insert(into.merged.end(), from.merged.begin(), from.merged.end());
  std::sort(into.merged.begin(), into.merged.end());
  removed_.push_back({id_of(gone), id_of(survivor), 0});
  states_[gone].reset();
  refit(survivor);
  mark_changed(survivor);
  return survivor;
}

void PlaneMap::start(UncertainGrid& grid, const LocalPlane& local, std::int64_t utime, GlobalReport& report) {
  const std::span<const CellRef> free = free_cells(grid, local);
  if (static_cast<double>(free.size()) < config_.min_cells) return;
  if (local.fit.width_m() < config_.min_width_cells * grid.cell_size_m()) return;
  // A strip of hardly more than one cell's width leans to whatever is beside it, unless its cells hold nothing else.
  if (local.fit.width_m() < config_.strip_cells * grid.cell_size_m() && !is_pure(local.statistics, local.fit)) return;
  const auto slot = static_cast<PlaneSlot>(states_.size());
  states_.push_back(std::make_unique<State>(grid.geometric_centre_m(local.cells.front())));
  State& plane = state(slot);
  plane.fit = local.fit;
  plane.first_seen_utime = utime;
  plane.last_seen_utime = utime;
  for (const CellRef ref : free) take(grid, ref, slot);
  refit(slot);
  born_.push_back(slot);
  ++report.new_planes;
}

void PlaneMap::merge_local(UncertainGrid& grid, const LocalPlane& local, const Neighbourhoods& neighbourhoods,
                           std::int64_t utime, GlobalReport& report) {
  const PlaneSlot target = absorb_into(grid, local, neighbourhoods, report);
  if (target == kNoSlot) {
    start(grid, local, utime, report);
    return;
  }
  for (const CellRef ref : free_cells(grid, local)) {
    const Cell& cell = grid.cell(ref);
    if (cell.plane == target || is_sibling(grid, ref, target)) continue;
    const double distance_m = std::abs(state(target).fit.plane.signed_distance_m(grid.middle_m(ref)));
    if (config_.offset_test && distance_m > band_m(cell, state(target).fit)) continue;
    take(grid, ref, target);
  }
  refit(target);
  state(target).last_seen_utime = std::max(state(target).last_seen_utime, utime);
}

GlobalReport PlaneMap::merge(UncertainGrid& grid, std::span<const LocalPlane> local,
                             std::span<const CellChange> changes, const Neighbourhoods& neighbourhoods,
                             const ScanPose& scan) {
  GlobalReport report;
  take_pose(scan);
  for (const LocalPlane& plane : local) merge_local(grid, plane, neighbourhoods, scan.utime, report);
  if (config_.adoption) {
    adopt(grid, changes, neighbourhoods);
    for (const PlaneSlot slot : born_) settle(grid, slot, report);
  }
  born_.clear();
  if (grid_config_.second_surfaces) open_seconds(grid, changes);
  if (config_.bridge_gap_m > 0.0) bridge(grid, changes, report);
  dissolve_small(grid, report);
  for (const PlaneSlot slot : touched_) {
    if (!states_[slot]) continue;
    State& plane = state(slot);
    plane.touched = false;
    plane.last_seen_utime = std::max(plane.last_seen_utime, scan.utime);
    reweigh(grid, slot);
    refit(slot);
    plane.pose_evidence.update(plane.statistics.evidence(), plane.fit.plane.normal(), plane.statistics.origin_m(), scan,
                               pose_error_);
  }
  touched_.clear();
  return report;
}

/// The bands hold cells of many scans: they are as wide as the mean of what the scans say.
void PlaneMap::take_pose(const ScanPose& scan) {
  last_pose_ = scan.covariance_or(pose_error_);
  poses_err_ = poses_err_ || !last_pose_.isZero(0.0);
  const double variance_m2 = band_variance_m2(last_pose_, config_.plane_offset_m);
  pose_variance_m2_ += (variance_m2 - pose_variance_m2_) / static_cast<double>(++scans_);
}

// What lifts the paper.

PlaneSlot PlaneMap::best_neighbour(const UncertainGrid& grid, CellRef ref, std::span<const CellRef> around) const {
  const Cell& cell = grid.cell(ref);
  const Eigen::Vector3d centre_m = grid.middle_m(ref);
  const double own_cells = cell.plane == kNoSlot ? 0.0 : static_cast<double>(state(cell.plane).statistics.cell_count());
  // Near an edge a normal may be wrong by 25 degrees, but not by a right angle.
  constexpr double kAdoptingCosine = 0.7;
  const auto sibling = grid.sibling(ref);
  const PlaneSlot sibling_plane = sibling ? grid.cell(*sibling).plane : kNoSlot;
  PlaneSlot best = kNoSlot;
  double best_distance_m = std::numeric_limits<double>::infinity();
  for (const CellRef other : around) {
    const PlaneSlot slot = grid.cell(other).plane;
    if (slot == kNoSlot || slot == cell.plane || slot == best || slot == sibling_plane) continue;
    const State& plane = state(slot);
    const Eigen::Vector3d& normal = plane.fit.plane.normal();
    if (config_.view_side && normal.dot(cell.sums.view.cast<double>()) <= 0.0) continue;
    if (cell.has_normal() && normal.dot(cell.normal.cast<double>()) < kAdoptingCosine) continue;
    const double distance_m = std::abs(plane.fit.plane.signed_distance_m(centre_m));
    if (distance_m >= best_distance_m || distance_m > band_m(cell, plane.fit)) continue;
    if (distance_m > config_.cell_offset_m || cell.plane != kNoSlot) {
      // A layer of the plane's slab: the plane's own cells lie behind or before it, not beside it.
      const Eigen::Vector3d step = grid.middle_m(other) - centre_m;
      if (std::abs(normal.dot(step)) < 0.5 * step.norm()) continue;
    }
    if (cell.plane != kNoSlot && static_cast<double>(plane.statistics.cell_count()) < config_.slab_ratio * own_cells) {
      continue;
    }
    best = slot;
    best_distance_m = distance_m;
  }
  return best;
}

void PlaneMap::adopt(UncertainGrid& grid, std::span<const CellChange> changes, const Neighbourhoods& neighbourhoods) {
  for (std::uint32_t i = 0; i < changes.size(); ++i) {
    const CellChange& change = changes[i];
    const Cell& cell = grid.cell(change.cell);
    if (cell.sums.count <= grid_config_.density_threshold) continue;
    if (const PlaneSlot better = better_neighbour(grid, change.cell, neighbourhoods.around(i)); better != kNoSlot) {
      take(grid, change.cell, better);
      continue;
    }
    if (cell.plane != kNoSlot && !(config_.slab_sigmas > 0.0)) continue;
    const PlaneSlot slot = best_neighbour(grid, change.cell, neighbourhoods.around(i));
    if (slot == kNoSlot) continue;
    take(grid, change.cell, slot);
  }
}

/// A new plane takes in what lay around it without a plane, or in one that it is not on, and merges with what it
/// thereby reaches: nobody may look there again.
void PlaneMap::settle(UncertainGrid& grid, PlaneSlot slot, GlobalReport& report) {
  if (!states_[slot]) return;
  const auto look_around = [&](CellRef ref) {
    around_.clear();
    grid.for_each_neighbour(ref, 1, [&](CellRef other) { around_.push_back(other); });
  };
  for (std::size_t next = 0; next < state(slot).cells.size(); ++next) {
    look_around(state(slot).cells[next]);
    others_.clear();
    std::copy_if(around_.begin(), around_.end(), std::back_inserter(others_), [&](CellRef other) {
      const Cell& cell = grid.cell(other);
      return cell.plane != slot && cell.sums.count > grid_config_.density_threshold;
    });
    for (const CellRef ref : others_) {
      look_around(ref);
      const bool free = grid.cell(ref).plane == kNoSlot;
      const PlaneSlot goes_to = free ? best_neighbour(grid, ref, around_) : better_neighbour(grid, ref, around_);
      if (goes_to == slot) take(grid, ref, slot);
    }
  }
  refit(slot);
  begin_touching();
  for (const CellRef ref : state(slot).cells) {
    look_around(ref);
    note_touching(grid, around_);
  }
  std::sort(touching_.begin(), touching_.end());
  for (const PlaneSlot other : touching_) {
    if (other != slot && states_[other]) slot = merge_if_agreed(grid, slot, other, report);
  }
}

void PlaneMap::dissolve_small(UncertainGrid& grid, GlobalReport& report) {
  candidates_ = touched_;
  for (const PlaneSlot slot : candidates_) {
    if (!states_[slot] || 3 * state(slot).statistics.cell_count() >= static_cast<std::size_t>(config_.min_cells))
      continue;
    dissolve(grid, slot);
    ++report.removed_planes;
  }
}

void PlaneMap::dissolve(UncertainGrid& grid, PlaneSlot slot) {
  for (const CellRef ref : state(slot).cells) {
    if (grid.cell(ref).plane == slot) leave(grid, ref);
  }
  removed_.push_back({id_of(slot), kNoPlane, 0});
  states_[slot].reset();
}

}  // namespace planemap

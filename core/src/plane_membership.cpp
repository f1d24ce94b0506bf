// Which cells belong to a plane, and how much of their evidence shapes it.

#include <algorithm>
#include <cmath>

#include "planemap/membership.hpp"
#include "planemap/plane_map.hpp"
#include "sort_unique.hpp"

namespace planemap {

namespace {

/// Small planes are weighed anew with each scan that touches them: their fit still moves, and with it who shapes them.
/// That bounds the work of a scan; in larger planes a cell is weighed when it is touched.
constexpr std::size_t kReweighedCells = 256;

}  // namespace

double PlaneMap::band_m(const Cell& cell, const PlaneFit& fit) const {
  // Poses that wander move what they see: without their part the band cuts off what it is to hold.
  const double variance_m2 = cell.sums.point_variance(fit.plane.normal()) + pose_variance_m2_;
  return std::max(config_.cell_offset_m, config_.slab_sigmas * std::sqrt(variance_m2));
}

const Plane* PlaneMap::dividing_plane(PlaneSlot slot) const {
  constexpr int kEstablished = 2;  // times what starts a plane
  if (slot == kNoSlot || !states_[slot]) return nullptr;
  const State& plane = state(slot);
  if (static_cast<double>(plane.statistics.cell_count()) < kEstablished * config_.min_cells) return nullptr;
  return &plane.fit.plane;
}

float PlaneMap::member_weight(const UncertainGrid& grid, CellRef ref, const PlaneFit& fit) const {
  const Cell& cell = grid.cell(ref);
  const Eigen::Vector3d& normal = fit.plane.normal();
  if (!(config_.core_sigmas > 0.0)) return 1.0F;
  if (!cell.has_evidence()) return 0.0F;
  // A cell at an edge also holds points of another surface: it belongs to the plane but must not shape it. Its points
  // scatter about the plane by more than their errors, and its normal turns away.
  const double d_m = fit.plane.signed_distance_m(grid.geometric_centre_m(ref));
  const double variance_m2 = cell.evidence_variance_m2() + pose_variance_m2_;
  const double expected_m2 =
      expected_scatter_m2(d_m, grid.cell_size_m(), variance_m2) + config_.core_floor_m * config_.core_floor_m;
  const double ratio = cell.evidence.unpacked().mean_square_distance(normal, d_m) / expected_m2;
  if (ratio > config_.core_sigmas * config_.core_sigmas) return 0.0F;
  // The normal of a layer of noise says nothing of what else is there.
  const double layered_m = kLayeredShare * grid.cell_size_m();
  if (variance_m2 < layered_m * layered_m && cell.has_normal() &&
      normal.dot(cell.normal.cast<double>()) < core_cosine_) {
    return 0.0F;
  }
  const double excess = std::max(1.0, ratio);
  return static_cast<float>(1.0 / (excess * excess));
}

void PlaneMap::forget_left_cells(const UncertainGrid& grid, PlaneSlot slot) {
  std::vector<CellRef>& cells = state(slot).cells;
  const auto left = [&](CellRef ref) { return grid.cell(ref).plane != slot; };
  cells.erase(std::remove_if(cells.begin(), cells.end(), left), cells.end());
  sort_unique(cells);
}

void PlaneMap::reweigh(UncertainGrid& grid, PlaneSlot slot) {
  State& plane = state(slot);
  const std::size_t members = plane.statistics.cell_count();
  const bool small = members <= kReweighedCells;
  if (small || plane.cells.size() > 2 * members) forget_left_cells(grid, slot);
  if (!small || plane.cells.empty() || !(config_.core_sigmas > 0.0)) return;
  // Where no cell is good enough to shape the plane, they all do.
  const bool any_core = std::any_of(plane.cells.begin(), plane.cells.end(),
                                    [&](CellRef ref) { return member_weight(grid, ref, plane.fit) > 0.0F; });
  PlaneStatistics fresh(plane.statistics.origin_m());  // that its pose evidence is about, too
  for (const CellRef ref : plane.cells) {
    Cell& cell = grid.writable(ref);
    cell.plane_weight = any_core ? member_weight(grid, ref, plane.fit) : 1.0F;
    fresh.add(cell, grid.geometric_centre_m(ref));
  }
  plane.statistics = fresh;
}

void PlaneMap::join(UncertainGrid& grid, CellRef ref, PlaneSlot slot) {
  Cell& cell = grid.writable(ref);
  cell.plane = slot;
  cell.plane_weight = member_weight(grid, ref, state(slot).fit);
  const Eigen::Vector3d centre_m = grid.geometric_centre_m(ref);
  state(slot).statistics.add(cell, centre_m);
  state(slot).cells.push_back(ref);
  coarse_.add(centre_m, slot);
  mark_changed(slot);
}

void PlaneMap::take(UncertainGrid& grid, CellRef ref, PlaneSlot slot) {
  if (grid.cell(ref).plane != kNoSlot) leave(grid, ref);
  join(grid, ref, slot);
}

void PlaneMap::leave(UncertainGrid& grid, CellRef ref) {
  Cell& cell = grid.writable(ref);
  const Eigen::Vector3d centre_m = grid.geometric_centre_m(ref);
  state(cell.plane).statistics.remove(cell, centre_m);
  coarse_.remove(centre_m, cell.plane);
  mark_changed(cell.plane);
  cell.plane = kNoSlot;
}

void PlaneMap::detach(const UncertainGrid& grid, CellRef ref) {
  const Cell& cell = grid.cell(ref);
  if (cell.plane != kNoSlot) state(cell.plane).statistics.remove(cell, grid.geometric_centre_m(ref));
}

void PlaneMap::attach(UncertainGrid& grid, CellRef ref) {
  if (grid.cell(ref).plane == kNoSlot) return;
  Cell& cell = grid.writable(ref);
  State& plane = state(cell.plane);
  cell.plane_weight = member_weight(grid, ref, plane.fit);
  plane.statistics.add(cell, grid.geometric_centre_m(ref));
  mark_changed(cell.plane);
  if (!config_.offset_test) return;
  const double distance_m = std::abs(plane.fit.plane.signed_distance_m(grid.middle_m(ref)));
  const bool side = !config_.view_side || plane.fit.plane.normal().dot(cell.sums.view.cast<double>()) > 0.0;
  constexpr double kHysteresis = 1.5;  // so that a cell on the limit does not come and go
  if (distance_m > kHysteresis * band_m(cell, plane.fit) || !side) leave(grid, ref);
}

}  // namespace planemap

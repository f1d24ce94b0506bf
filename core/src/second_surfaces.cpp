// Cells that two surfaces pass through: each surface gets a cell of its own there.

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "planemap/membership.hpp"
#include "planemap/plane_map.hpp"

namespace planemap {

namespace {

/// Whether a cell's points scatter about every plane by more than their errors and what a bent surface does within a
/// cell: then they are of two surfaces. Noise that fills the cell hides that.
bool holds_two(const Cell& cell, double cell_size_m) {
  constexpr double kSigmas = 1.5;
  constexpr double kFloor_m = 0.003;
  if (!cell.has_evidence()) return false;
  const double variance_m2 = cell.evidence_variance_m2();
  if (is_layered(variance_m2, cell_size_m)) return false;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(cell.evidence.unpacked().covariance(), Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(0) > kSigmas * kSigmas * variance_m2 + kFloor_m * kFloor_m;
}

}  // namespace

bool PlaneMap::is_sibling(const UncertainGrid& grid, CellRef ref, PlaneSlot slot) const {
  const auto sibling = grid.sibling(ref);
  return sibling && grid.cell(*sibling).plane == slot;
}

/// The well-known plane that passes through a cell and holds most of its points: its own, or that of a neighbour that
/// shapes it. kNoSlot: there is none.
PlaneSlot PlaneMap::plane_through(const UncertainGrid& grid, CellRef ref) const {
  const Cell& cell = grid.cell(ref);
  const Eigen::Vector3d centre_m = grid.geometric_centre_m(ref);
  const Moments evidence = cell.evidence.unpacked();
  PlaneSlot best = kNoSlot;
  double least_m2 = std::numeric_limits<double>::infinity();
  const auto consider = [&](PlaneSlot slot) {
    if (slot == best) return;
    const Plane* plane = dividing_plane(slot);
    if (plane == nullptr) return;
    const double d_m = plane->signed_distance_m(centre_m);
    if (std::abs(d_m) > 0.5 * grid.cell_size_m() * plane->normal().lpNorm<1>()) return;
    const double scatter_m2 = evidence.mean_square_distance(plane->normal(), d_m);
    if (scatter_m2 >= least_m2) return;
    best = slot;
    least_m2 = scatter_m2;
  };
  if (cell.plane != kNoSlot) {
    consider(cell.plane);
    return best;
  }
  grid.for_each_neighbour(ref, 1, [&](CellRef other) {
    if (grid.cell(other).plane_weight > 0.0F && grid.cell(other).plane != kNoSlot) consider(grid.cell(other).plane);
  });
  return best;
}

void PlaneMap::open_seconds(UncertainGrid& grid, std::span<const CellChange> changes) {
  for (const CellChange& change : changes) {
    const CellRef ref = change.cell;
    const Cell& cell = grid.cell(ref);
    if (cell.sums.count <= grid_config_.density_threshold || cell.is_second || cell.second != Cell::kNoSecond) continue;
    if (cell.plane != kNoSlot && cell.plane_weight > 0.5F) continue;
    if (!holds_two(cell, grid.cell_size_m())) continue;
    const PlaneSlot slot = plane_through(grid, ref);
    if (slot == kNoSlot) continue;
    // What it has cannot be told apart any more: both cells' evidence begins anew.
    detach(grid, ref);
    Cell& emptied = grid.writable(ref);
    emptied.begin_evidence_anew();
    if (emptied.plane == kNoSlot) {
      join(grid, ref, slot);
    } else {
      state(slot).statistics.add(emptied, grid.geometric_centre_m(ref));
      mark_changed(slot);
    }
    grid.find_or_add_second(ref);
  }
}

}  // namespace planemap

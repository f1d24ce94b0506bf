// Flat pieces that make a crease are two planes, and each cell is of the one that its points are on.

#include <algorithm>
#include <cmath>

#include "angles.hpp"
#include "planemap/membership.hpp"
#include "planemap/plane_map.hpp"

namespace planemap {

bool PlaneMap::is_pure(const PlaneStatistics& statistics, const PlaneFit& fit) const {
  // A cell across a corner scatters about its chord by a tenth of its edge: only less noise than that tells it from one
  // that is flat.
  constexpr double kMostNoise = 0.075;
  constexpr double kPureSigmas = 1.2;
  const double variance_m2 = statistics.evidence_variance_m2() + pose_variance_m2_;
  const double most_m = kMostNoise * grid_config_.cell_size_m;
  return variance_m2 < most_m * most_m &&
         fit.residual_m2 < kPureSigmas * kPureSigmas * variance_m2 + config_.core_floor_m * config_.core_floor_m;
}

bool PlaneMap::are_creased(const PlaneStatistics& a, const PlaneFit& fit_a, const PlaneStatistics& b,
                           const PlaneFit& fit_b) const {
  if (!config_.splits || !is_pure(a, fit_a) || !is_pure(b, fit_b)) return false;
  constexpr double kSigmas = 3.0;
  const double sigma_rad = std::sqrt(fit_a.tilt_1_rad2 + fit_b.tilt_1_rad2);
  const double angle_rad = std::acos(std::min(1.0, fit_a.plane.normal().dot(fit_b.plane.normal())));
  return angle_rad > config_.crease_angle_deg * kRadPerDeg + kSigmas * sigma_rad;
}

bool PlaneMap::is_nearer(const UncertainGrid& grid, CellRef ref, const PlaneFit& a, const PlaneFit& b) const {
  const Moments evidence = grid.cell(ref).evidence.unpacked();
  const Eigen::Vector3d centre_m = grid.geometric_centre_m(ref);
  const auto scatter_m2 = [&](const PlaneFit& fit) {
    return evidence.mean_square_distance(fit.plane.normal(), fit.plane.signed_distance_m(centre_m));
  };
  return scatter_m2(a) < scatter_m2(b);
}

std::span<const CellRef> PlaneMap::free_cells(const UncertainGrid& grid, const LocalPlane& local) {
  free_.clear();
  PlaneSlot last = kNoSlot;
  bool creased = false;
  for (const CellRef ref : local.cells) {
    const PlaneSlot slot = grid.cell(ref).plane;
    if (slot != last && slot != kNoSlot) {
      creased = are_creased(local.statistics, local.fit, state(slot).statistics, state(slot).fit);
    }
    last = slot;
    if (slot == kNoSlot || (creased && is_nearer(grid, ref, local.fit, state(slot).fit))) free_.push_back(ref);
  }
  return free_;
}

PlaneSlot PlaneMap::better_neighbour(const UncertainGrid& grid, CellRef ref, std::span<const CellRef> around) const {
  constexpr double kNearer_m = 0.003;  // more than flat planes err by
  constexpr double kSigmas = 3.0;
  const Cell& cell = grid.cell(ref);
  if (!config_.splits || cell.plane == kNoSlot || !cell.has_evidence()) return kNoSlot;
  const double variance_m2 = cell.evidence_variance_m2();
  if (is_layered(variance_m2, grid.cell_size_m())) return kNoSlot;
  const double sigma_m = std::sqrt(variance_m2 / static_cast<double>(cell.evidence_count) + pose_variance_m2_);
  const Eigen::Vector3d mean_m = grid.geometric_centre_m(ref) + cell.evidence.unpacked().mean();
  const auto is_flat = [&](PlaneSlot slot) { return is_pure(state(slot).statistics, state(slot).fit); };
  const Plane& own = state(cell.plane).fit.plane;
  double least_m = std::abs(own.signed_distance_m(mean_m)) - kNearer_m - kSigmas * sigma_m;
  if (least_m <= 0.0 || !is_flat(cell.plane)) return kNoSlot;
  PlaneSlot best = kNoSlot;
  PlaneSlot last = cell.plane;
  for (const CellRef other : around) {
    const PlaneSlot slot = grid.cell(other).plane;
    if (slot == kNoSlot || slot == last || slot == cell.plane || is_sibling(grid, ref, slot)) continue;
    last = slot;
    const Plane& plane = state(slot).fit.plane;
    const double distance_m = std::abs(plane.signed_distance_m(mean_m));
    if (distance_m >= least_m || plane.normal().dot(own.normal()) < alike_cosine_ || !is_flat(slot)) continue;
    least_m = distance_m;
    best = slot;
  }
  return best;
}

}  // namespace planemap

#include "planemap/local_planes.hpp"

#include <algorithm>
#include <cmath>

#include "angles.hpp"
#include "planemap/membership.hpp"

namespace planemap {

LocalPlaneExtractor::LocalPlaneExtractor(const GridConfig& grid, const NormalConfig& normals, const PlaneConfig& planes)
    : grid_config_(grid),
      normal_config_(normals),
      config_(planes),
      squared_chord_(squared_chord(planes.normal_angle_deg * kRadPerDeg)) {}

bool LocalPlaneExtractor::eligible(const Cell& cell) const {
  return cell.sums.count > grid_config_.density_threshold && cell.has_normal() &&
         static_cast<double>(cell.deviation_rad) <= normal_config_.max_deviation_deg * kRadPerDeg;
}

std::vector<std::uint32_t> LocalPlaneExtractor::seeds(const UncertainGrid& grid,
                                                      std::span<const CellChange> changes) const {
  std::vector<std::uint32_t> order;  // Fig. 3, line 4: the dense cells
  for (std::uint32_t i = 0; i < changes.size(); ++i) {
    if (eligible(grid.cell(changes[i].cell))) order.push_back(i);
  }
  if (config_.best_seeds_first) {
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return grid.cell(changes[a].cell).deviation_rad < grid.cell(changes[b].cell).deviation_rad;
    });
  }
  return order;
}

std::vector<LocalPlane> LocalPlaneExtractor::extract(const UncertainGrid& grid, std::span<const CellChange> changes) {
  visited_.assign(changes.size(), 0);
  visitor_ = 0;
  std::vector<LocalPlane> planes;
  for (const std::uint32_t seed : seeds(grid, changes)) {
    if (visited_[seed] == kTaken) continue;
    if (auto plane = grow(grid, changes, seed)) planes.push_back(std::move(*plane));
  }
  return planes;
}

bool LocalPlaneExtractor::similar(const UncertainGrid& grid, CellRef ref, const PlaneFit& plane) const {
  const Cell& cell = grid.cell(ref);
  if (!eligible(cell)) return false;
  if (expected_squared_distance(plane.plane.normal(), plane.deviation_rad, cell.normal.cast<double>(),
                                static_cast<double>(cell.deviation_rad)) >= squared_chord_) {
    return false;
  }
  if (!config_.offset_test) return true;
  if (std::abs(plane.plane.signed_distance_m(grid.virtual_centre_m(ref))) >= config_.cell_offset_m) return false;
  return !config_.splits || plane.weight <= 0.0 ||
         !is_other_surface(cell, grid.geometric_centre_m(ref), plane.plane, grid.cell_size_m());
}

std::optional<LocalPlane> LocalPlaneExtractor::grow(const UncertainGrid& grid, std::span<const CellChange> changes,
                                                    std::uint32_t seed) {
  const CellRef first = changes[seed].cell;
  const Cell& first_cell = grid.cell(first);
  LocalPlane plane{PlaneStatistics(grid.geometric_centre_m(first)), {}, {}};
  // The plane starts as its first cell: its normal, through its virtual centre.
  plane.fit.plane = Plane::through(grid.virtual_centre_m(first), first_cell.normal.cast<double>());
  plane.fit.deviation_rad = static_cast<double>(first_cell.deviation_rad);
  ++visitor_;
  const auto take = [&](CellRef ref) {
    Cell member = grid.cell(ref);
    member.plane_weight = 1.0F;
    plane.statistics.add(member, grid.geometric_centre_m(ref));
    plane.cells.push_back(ref);
  };
  visited_[seed] = kTaken;
  take(first);
  std::size_t refit_at = config_.pooled_refit ? 6 : 1;  // fewer cells tilt more than the first cell's normal does
  for (std::size_t next = 0; next < plane.cells.size(); ++next) {
    grid.for_each_neighbour(plane.cells[next], 1, [&](CellRef other) {
      const std::uint32_t change = grid.cell(other).working;
      if (change == Cell::kNotWorking || visited_[change] == kTaken || visited_[change] == visitor_) return;
      visited_[change] = visitor_;
      if (!similar(grid, other, plane.fit)) return;
      visited_[change] = kTaken;
      take(other);
      if (plane.cells.size() < refit_at) return;
      if (const auto fit = plane.statistics.fit(config_.pooled_refit)) plane.fit = *fit;
      refit_at = config_.pooled_refit ? plane.cells.size() + 1 + plane.cells.size() / 8 : plane.cells.size() + 1;
    });
  }
  const auto fit = plane.statistics.fit(config_.pooled_refit);
  if (!fit) return std::nullopt;
  plane.fit = *fit;
  return plane;
}

}  // namespace planemap

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
  aside_.clear();
  const std::vector<std::uint32_t> order = seeds(grid, changes);
  std::vector<LocalPlane> planes;
  const auto grow_all = [&](bool strict) {
    for (const std::uint32_t seed : order) {
      if (visited_[seed] == kTaken) continue;
      const std::size_t number = planes.size();
      planes.push_back(start(grid, changes[seed].cell));
      grow(grid, planes.back(), 0, strict ? &number : nullptr);
    }
  };
  if (config_.splits) {
    // What lies aside of a plane is kept out of it where it makes a plane of its own. Else the plane takes it, too: a
    // real sensor bends what is flat.
    grow_all(true);
    for (LocalPlane& plane : planes) release_small(grid, plane);
    for (const auto& [number, ref] : aside_) take_aside(grid, ref, planes[number]);
  }
  grow_all(false);
  const auto is_none = [&](LocalPlane& plane) {
    const auto fit = plane.cells.empty() ? std::nullopt : plane.statistics.fit(config_.pooled_refit);
    if (fit) plane.fit = *fit;
    return !fit;
  };
  std::erase_if(planes, is_none);
  return planes;
}

void LocalPlaneExtractor::release_small(const UncertainGrid& grid, LocalPlane& plane) {
  if (static_cast<double>(plane.cells.size()) >= config_.min_cells) return;
  for (const CellRef ref : plane.cells) visited_[grid.cell(ref).working] = 0;
  plane.cells.clear();
}

void LocalPlaneExtractor::take_aside(const UncertainGrid& grid, CellRef ref, LocalPlane& plane) {
  std::uint32_t& visited = visited_[grid.cell(ref).working];
  if (plane.cells.empty() || visited == kTaken || !similar(grid, ref, plane.fit)) return;
  ++visitor_;
  visited = kTaken;
  take(grid, ref, plane);
  grow(grid, plane, plane.cells.size() - 1, nullptr);
}

bool LocalPlaneExtractor::similar(const UncertainGrid& grid, CellRef ref, const PlaneFit& plane) const {
  const Cell& cell = grid.cell(ref);
  if (!eligible(cell)) return false;
  if (expected_squared_distance(plane.plane.normal(), plane.deviation_rad, cell.normal.cast<double>(),
                                static_cast<double>(cell.deviation_rad)) >= squared_chord_) {
    return false;
  }
  return !config_.offset_test || std::abs(plane.plane.signed_distance_m(grid.middle_m(ref))) < config_.cell_offset_m;
}

LocalPlane LocalPlaneExtractor::start(const UncertainGrid& grid, CellRef first) {
  const Cell& cell = grid.cell(first);
  LocalPlane plane{PlaneStatistics(grid.geometric_centre_m(first)), {}, {}};
  // The plane starts as its first cell: its normal, through its virtual centre.
  plane.fit.plane = Plane::through(grid.middle_m(first), cell.normal.cast<double>());
  plane.fit.deviation_rad = static_cast<double>(cell.deviation_rad);
  ++visitor_;
  visited_[cell.working] = kTaken;
  take(grid, first, plane);
  return plane;
}

void LocalPlaneExtractor::take(const UncertainGrid& grid, CellRef ref, LocalPlane& plane) {
  Cell member = grid.cell(ref);
  member.plane_weight = 1.0F;
  plane.statistics.add(member, grid.geometric_centre_m(ref));
  plane.cells.push_back(ref);
}

void LocalPlaneExtractor::grow(const UncertainGrid& grid, LocalPlane& plane, std::size_t from,
                               const std::size_t* number) {
  // Fewer cells tilt more than the first cell's normal does; later a fit that gained an eighth is as good as any.
  const auto next_refit = [&](std::size_t cells) {
    return config_.pooled_refit ? std::max<std::size_t>(6, cells + 1 + cells / 8) : cells + 1;
  };
  std::size_t refit_at = plane.cells.size() == 1 ? (config_.pooled_refit ? 6 : 1) : next_refit(plane.cells.size());
  for (std::size_t next = from; next < plane.cells.size(); ++next) {
    grid.for_each_neighbour(plane.cells[next], 1, [&](CellRef other) {
      const std::uint32_t change = grid.cell(other).working;
      if (change == Cell::kNotWorking || visited_[change] == kTaken || visited_[change] == visitor_) return;
      visited_[change] = visitor_;
      if (!similar(grid, other, plane.fit)) return;
      // Its weight is known once it was fitted.
      if (number != nullptr && plane.fit.weight > 0.0 &&
          lies_aside(grid.cell(other), grid.geometric_centre_m(other), plane.fit.plane, grid.cell_size_m())) {
        aside_.emplace_back(*number, other);
        return;
      }
      visited_[change] = kTaken;
      take(grid, other, plane);
      if (plane.cells.size() < refit_at) return;
      if (const auto fit = plane.statistics.fit(config_.pooled_refit)) plane.fit = *fit;
      refit_at = next_refit(plane.cells.size());
    });
  }
}

}  // namespace planemap

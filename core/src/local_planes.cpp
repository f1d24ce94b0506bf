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

std::span<const LocalPlane> LocalPlaneExtractor::extract(const UncertainGrid& grid, std::span<const CellChange> changes,
                                                         const Neighbourhoods& neighbourhoods) {
  list_candidates(grid, changes, neighbourhoods);
  sort_seeds();
  growing_.clear();
  visitor_ = 0;
  aside_.clear();
  if (config_.splits) {
    // What lies aside of a plane is kept out of it where it makes a plane of its own. Else the plane takes it, too: a
    // real sensor bends what is flat.
    grow_all(grid, changes, true);
    for (Growing& plane : growing_) release_small(plane);
    for (const auto& [number, change] : aside_) take_aside(grid, changes, change, number);
  }
  grow_all(grid, changes, false);
  list_planes(changes);
  return planes_;
}

void LocalPlaneExtractor::list_candidates(const UncertainGrid& grid, std::span<const CellChange> changes,
                                          const Neighbourhoods& neighbourhoods) {
  candidates_.resize(changes.size());
  seeds_.clear();
  neighbours_.clear();
  for (std::uint32_t i = 0; i < changes.size(); ++i) {
    const Cell& cell = grid.cell(changes[i].cell);
    Candidate& candidate = candidates_[i];
    candidate.visitor = kTaken;
    if (!eligible(cell)) continue;
    candidate.visitor = 0;
    candidate.normal = cell.normal.cast<double>();
    candidate.middle_m = grid.middle_m(changes[i].cell);
    candidate.deviation_rad = static_cast<double>(cell.deviation_rad);
    seeds_.push_back(i);
  }
  for (const std::uint32_t i : seeds_) {
    candidates_[i].first_neighbour = static_cast<std::uint32_t>(neighbours_.size());
    for (const CellRef other : neighbourhoods.around(i)) {
      const std::uint32_t change = grid.cell(other).working;
      if (change != Cell::kNotWorking && candidates_[change].visitor != kTaken) neighbours_.push_back(change);
    }
    candidates_[i].last_neighbour = static_cast<std::uint32_t>(neighbours_.size());
  }
}

void LocalPlaneExtractor::sort_seeds() {
  if (!config_.best_seeds_first) return;
  std::sort(seeds_.begin(), seeds_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double first = candidates_[a].deviation_rad;
    const double second = candidates_[b].deviation_rad;
    return first != second ? first < second : a < b;
  });
}

void LocalPlaneExtractor::grow_all(const UncertainGrid& grid, std::span<const CellChange> changes, bool strict) {
  for (const std::uint32_t seed : seeds_) {
    if (candidates_[seed].visitor == kTaken) continue;
    grow(grid, changes, start(grid, changes, seed), seed, strict);
  }
}

std::size_t LocalPlaneExtractor::start(const UncertainGrid& grid, std::span<const CellChange> changes,
                                       std::uint32_t change) {
  const CellRef first = changes[change].cell;
  Growing& plane = growing_.emplace_back(Growing{PlaneStatistics(grid.geometric_centre_m(first)), {}});
  // The plane starts as its first cell: its normal, through its virtual centre.
  const Candidate& seed = candidates_[change];
  plane.fit.plane = Plane::through(seed.middle_m, seed.normal);
  plane.fit.deviation_rad = seed.deviation_rad;
  ++visitor_;
  take(grid, first, change, plane);
  return growing_.size() - 1;
}

void LocalPlaneExtractor::take(const UncertainGrid& grid, CellRef ref, std::uint32_t change, Growing& plane) {
  candidates_[change].visitor = kTaken;
  candidates_[change].next = kNone;
  (plane.size == 0 ? plane.first : candidates_[plane.last].next) = change;
  plane.last = change;
  ++plane.size;
  plane.statistics.add_whole(grid.cell(ref), grid.geometric_centre_m(ref));
}

void LocalPlaneExtractor::release_small(Growing& plane) {
  if (static_cast<double>(plane.size) >= config_.min_cells) return;
  for (std::uint32_t i = plane.first; i != kNone; i = candidates_[i].next) candidates_[i].visitor = 0;
  plane.size = 0;
}

void LocalPlaneExtractor::take_aside(const UncertainGrid& grid, std::span<const CellChange> changes,
                                     std::uint32_t change, std::size_t number) {
  Growing& plane = growing_[number];
  const Candidate& cell = candidates_[change];
  if (plane.size == 0 || cell.visitor == kTaken || !similar(cell, plane.fit)) return;
  ++visitor_;
  take(grid, changes[change].cell, change, plane);
  grow(grid, changes, number, change, false);
}

bool LocalPlaneExtractor::similar(const Candidate& cell, const PlaneFit& plane) const {
  if (expected_squared_distance(plane.plane.normal(), plane.deviation_rad, cell.normal, cell.deviation_rad) >=
      squared_chord_) {
    return false;
  }
  return !config_.offset_test || std::abs(plane.plane.signed_distance_m(cell.middle_m)) < config_.cell_offset_m;
}

void LocalPlaneExtractor::grow(const UncertainGrid& grid, std::span<const CellChange> changes, std::size_t number,
                               std::uint32_t from, bool strict) {
  Growing& plane = growing_[number];
  // Fewer cells tilt more than the first cell's normal does; later a fit that gained an eighth is as good as any.
  const auto next_refit = [&](std::size_t cells) {
    return config_.pooled_refit ? std::max<std::size_t>(6, cells + 1 + cells / 8) : cells + 1;
  };
  std::size_t refit_at = plane.size == 1 ? (config_.pooled_refit ? 6 : 1) : next_refit(plane.size);
  for (std::uint32_t at = from; at != kNone; at = candidates_[at].next) {
    const std::uint32_t end = candidates_[at].last_neighbour;
    for (std::uint32_t i = candidates_[at].first_neighbour; i < end; ++i) {
      const std::uint32_t change = neighbours_[i];
      Candidate& other = candidates_[change];
      if (other.visitor == kTaken || other.visitor == visitor_) continue;
      other.visitor = visitor_;
      if (!similar(other, plane.fit)) continue;
      const CellRef ref = changes[change].cell;
      // Its weight is known once it was fitted.
      if (strict && plane.fit.weight > 0.0 &&
          lies_aside(grid.cell(ref), grid.geometric_centre_m(ref), plane.fit.plane, grid.cell_size_m())) {
        aside_.emplace_back(number, change);
        continue;
      }
      take(grid, ref, change, plane);
      if (plane.size < refit_at) continue;
      if (const auto fit = plane.statistics.fit(config_.pooled_refit)) plane.fit = *fit;
      refit_at = next_refit(plane.size);
    }
  }
}

/// Those that span a plane, and their cells one after another.
void LocalPlaneExtractor::list_planes(std::span<const CellChange> changes) {
  planes_.clear();
  cells_.clear();
  // Each cell is in one plane at most: the spans hold.
  if (cells_.capacity() < changes.size()) cells_.reserve(2 * changes.size());
  for (const Growing& plane : growing_) {
    const auto fit = plane.size == 0 ? std::nullopt : plane.statistics.fit(config_.pooled_refit);
    if (!fit) continue;
    const std::size_t begin = cells_.size();
    for (std::uint32_t i = plane.first; i != kNone; i = candidates_[i].next) cells_.push_back(changes[i].cell);
    planes_.push_back({plane.statistics, *fit, std::span(cells_).subspan(begin)});
  }
}

}  // namespace planemap

#include "planemap/snapshot.hpp"

#include <algorithm>

#include "planemap/block.hpp"

namespace planemap {

const PlaneRecord* MapSnapshot::find(PlaneId id) const {
  const auto at = std::lower_bound(parts_.planes.begin(), parts_.planes.end(), id,
                                   [](const auto& record, PlaneId wanted) { return record->id < wanted; });
  return at != parts_.planes.end() && (*at)->id == id ? at->get() : nullptr;
}

std::optional<MapDelta> MapSnapshot::delta_since(std::uint64_t revision) const {
  if (revision > parts_.revision || revision < parts_.removed_complete_since) return std::nullopt;
  MapDelta delta{parts_.epoch, revision, parts_.revision, parts_.utime, {}, {}};
  for (const auto& record : parts_.planes) {
    if (record->revision > revision) delta.changed.push_back(record);
  }
  for (const RemovedPlane& gone : parts_.removed) {
    if (gone.revision > revision) delta.removed.push_back(gone);
  }
  return delta;
}

bool MapSnapshot::is_dense(const Cell& cell) const {
  return cell.sums.count > parts_.density_threshold;
}

CellView MapSnapshot::view_of(const Block& block, std::size_t ordinal) const {
  const Cell& cell = block.cell(ordinal);
  const double n = cell.sums.count;
  CellView view;
  view.index = block.cell_index(ordinal);
  view.centre_m = (view.index.cast<double>().array() + 0.5).matrix() * parts_.cell_size_m + cell.sums.mean_m();
  view.sigma_m = cell.sums.error_m2.cast<double>().cwiseSqrt() / n;
  if (cell.has_normal()) view.normal = cell.normal.cast<double>();
  view.deviation_rad = static_cast<double>(cell.deviation_rad);
  view.count = static_cast<std::uint64_t>(n);
  view.plane_id = cell.plane;
  return view;
}

void MapSnapshot::for_each_cell(const std::function<void(const CellView&)>& visit) const {
  for (const auto& block : parts_.blocks) {
    for (std::size_t i = 0; i < block->size(); ++i) {
      if (is_dense(block->cell(i))) visit(view_of(*block, i));
    }
  }
}

}  // namespace planemap

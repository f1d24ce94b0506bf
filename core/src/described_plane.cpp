#include "planemap/described_plane.hpp"

#include <algorithm>
#include <planemap/block.hpp>
#include <planemap/classify.hpp>
#include <unordered_map>
#include <utility>

#include "describe.hpp"

namespace planemap {

namespace {

using CellsOfPlanes = std::unordered_map<PlaneId, std::vector<Eigen::Vector3d>>;

/// Adds the centres of a block's dense cells to those of their planes, where these are asked for.
void collect_cells(const MapSnapshot& snapshot, const Block& block, CellsOfPlanes& cells_of) {
  PlaneId last = kNoPlane;  // neighbours are mostly of one plane
  std::vector<Eigen::Vector3d>* cells_of_last = nullptr;
  for (std::size_t i = 0; i < block.size(); ++i) {
    const Cell& cell = block.cell(i);
    if (cell.plane != last) {
      last = cell.plane;
      const auto entry = cells_of.find(last);
      cells_of_last = entry == cells_of.end() ? nullptr : &entry->second;
    }
    if (cells_of_last != nullptr && snapshot.is_dense(cell)) {
      cells_of_last->push_back(snapshot.view_of(block, i).centre_m);
    }
  }
}

/// Adds the outlines that are missing, from the cells of the map.
void add_outlines(const MapSnapshot& snapshot, const PlaneBlocks& where, std::vector<DescribedPlane>& planes) {
  CellsOfPlanes cells_of_changed;
  for (const DescribedPlane& plane : planes) {
    if (!plane.outline) cells_of_changed.emplace(plane.record->id, std::vector<Eigen::Vector3d>{});
  }
  if (cells_of_changed.empty()) return;
  for (std::size_t i = 0; i < snapshot.blocks().size(); ++i) {
    const auto planes_here = where.planes_in(i);
    const bool any = std::any_of(planes_here.begin(), planes_here.end(),
                                 [&](PlaneSlot plane) { return cells_of_changed.contains(plane); });
    if (any) collect_cells(snapshot, *snapshot.blocks()[i], cells_of_changed);
  }
  for (DescribedPlane& plane : planes) {
    if (plane.outline) continue;
    const PlaneRecord& record = *plane.record;
    plane.outline = std::make_shared<const Outline>(
        outline_of(record.plane, record.centroid_m, cells_of_changed.at(record.id), snapshot.cell_size_m()));
  }
}

void add_classes(const std::optional<Eigen::Vector3d>& gravity, std::vector<DescribedPlane>& planes) {
  std::vector<Surface> surfaces;
  surfaces.reserve(planes.size());
  for (const DescribedPlane& plane : planes) {
    surfaces.push_back(Surface{plane.record->plane, plane.record->centroid_m, plane.outline->area_m2});
  }
  const auto classes = classify(surfaces, gravity);
  for (std::size_t i = 0; i < planes.size(); ++i) planes[i].plane_class = classes[i];
}

}  // namespace

std::vector<DescribedPlane> describe_planes(const MapSnapshot& snapshot, const std::optional<Eigen::Vector3d>& gravity,
                                            std::span<const DescribedPlane> previous) {
  return describe_planes(snapshot, gravity, previous, PlaneBlocks(snapshot.blocks()));
}

std::vector<DescribedPlane> describe_planes(const MapSnapshot& snapshot, const std::optional<Eigen::Vector3d>& gravity,
                                            std::span<const DescribedPlane> previous, const PlaneBlocks& where) {
  // The earlier planes hold their records, so an address says which record it is.
  std::unordered_map<const PlaneRecord*, std::shared_ptr<const Outline>> known;
  known.reserve(previous.size());
  for (const DescribedPlane& plane : previous) known.emplace(plane.record.get(), plane.outline);
  std::vector<DescribedPlane> planes;
  planes.reserve(snapshot.planes().size());
  for (const auto& record : snapshot.planes()) {
    const auto found = known.find(record.get());
    planes.push_back({record, found == known.end() ? nullptr : found->second, PlaneClass::kOther});
  }
  add_outlines(snapshot, where, planes);
  add_classes(gravity, planes);
  return planes;
}

}  // namespace planemap

#include "planemap/query/region.hpp"

#include <algorithm>
#include <cmath>

#include "query/argument_checks.hpp"
#include "query/queries.hpp"
#include "query/region_shape.hpp"

namespace planemap {

namespace {

/// What of a plane's surface is in the region; empty: nothing.
std::optional<RegionPlane> part_of(const DescribedPlane& plane, const RegionShape& shape, bool polygons) {
  RegionPlane part{plane, false, {}, 0.0};
  const Outline& outline = *plane.outline;
  // The region is convex, so it holds all of a polygon whose corners it holds.
  part.whole = std::all_of(outline.polygons.begin(), outline.polygons.end(), [&](const Polygon& polygon) {
    return std::all_of(polygon.outer.begin(), polygon.outer.end(),
                       [&](const Eigen::Vector2d& uv_m) { return shape.contains(outline.basis.to_world(uv_m)); });
  });
  if (part.whole) {
    if (!polygons) return part;
    part.polygons = outline.polygons;
    part.area_m2 = area_m2(part.polygons);
    return part;
  }
  std::vector<Ring> rings = rings_of(outline.polygons);
  const auto clip_by = [&rings](const std::vector<HalfPlane>& half_planes) {
    for (const HalfPlane& half_plane : half_planes) {
      if (!rings.empty()) clip(rings, half_plane);
    }
  };
  clip_by(shape.half_planes_on(outline.basis));
  if (rings.empty()) return std::nullopt;
  if (shape.round) {
    const RoundOnPlane round(*shape.round, outline.basis);
    if (!round.touches(rings)) return std::nullopt;
    if (!polygons) return part;
    const auto half_planes = round.half_planes();
    if (!half_planes) return part;  // it touches
    clip_by(*half_planes);
  }
  if (!polygons) return part;
  part.polygons = polygons_of(std::move(rings));
  part.area_m2 = area_m2(part.polygons);
  return part;
}

void add_cells(const MapSnapshot& snapshot, const Block& block, const RegionShape& shape, const FilterTest& filter,
               std::vector<CellView>& cells) {
  for (std::size_t i = 0; i < block.size(); ++i) {
    const Cell& cell = block.cell(i);
    if (!snapshot.is_dense(cell)) continue;
    const CellView view = snapshot.view_of(block, i);
    if (shape.contains(view.centre_m) && filter.passes_cell_of(view.plane_id)) cells.push_back(view);
  }
}

std::vector<CellView> cells_in(const QueryIndex& index, const RegionShape& shape, const FilterTest& filter) {
  const MapSnapshot& snapshot = *index.snapshot;
  const double edge_m = snapshot.cell_size_m() * kBlockEdge;
  // Virtual centres lie up to a few cells outside of their cubes, never a block.
  const Eigen::Vector3d margin_m = Eigen::Vector3d::Constant(edge_m);
  const Eigen::AlignedBox3d reach(shape.bounds.min() - margin_m, shape.bounds.max() + margin_m);
  std::vector<CellView> cells;
  const auto indices = index.blocks->indices();
  for (std::size_t slot = 0; slot < indices.size(); ++slot) {
    const Eigen::Vector3d corner_m = indices[slot].cast<double>() * edge_m;
    const Eigen::AlignedBox3d box(corner_m, corner_m + Eigen::Vector3d::Constant(edge_m));
    if (reach.intersects(box)) add_cells(snapshot, *snapshot.blocks()[slot], shape, filter, cells);
  }
  return cells;
}

}  // namespace

Expected<RegionContents> contents_of(const QueryIndex& index, const RegionQuery& query) {
  const auto shape = shape_of(query.region);
  if (!shape) return tl::make_unexpected(shape.error());
  if (auto error = check_filter(query.filter, *index.snapshot)) return failure(error);
  const FilterTest filter(index, query.filter);
  std::vector<std::size_t> near;
  index.tree.visit_within(shape->bounds, [&](PlaneTree::Item plane) {
    if (filter.passes(plane)) near.push_back(plane);
  });
  std::sort(near.begin(), near.end());
  RegionContents contents;
  for (const std::size_t plane : near) {
    if (auto part = part_of(index.planes[plane], *shape, query.polygons)) contents.planes.push_back(std::move(*part));
  }
  if (query.cells) contents.cells = cells_in(index, *shape, filter);
  return contents;
}

}  // namespace planemap

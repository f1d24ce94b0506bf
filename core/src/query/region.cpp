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
    auto half_planes = round.half_planes();
    if (!half_planes) return part;  // it touches
    // What cuts nothing away now never will, and each cut adds corners to ask.
    std::erase_if(*half_planes, [&](const HalfPlane& half_plane) { return holds(half_plane, rings); });
    clip_by(*half_planes);
  }
  if (!polygons) return part;
  part.polygons = polygons_of(std::move(rings));
  part.area_m2 = area_m2(part.polygons);
  return part;
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
  if (!query.cells) return contents;
  index.visit_cells(shape->bounds, [&](const CellView& cell) {
    if (shape->contains(cell.centre_m) && filter.passes_cell_of(cell.plane_id)) contents.cells.push_back(cell);
  });
  return contents;
}

}  // namespace planemap

#include "codec/answer_codec.hpp"

#include <algorithm>
#include <iterator>

#include "codec/plane_codec.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::plan_polygon_t;
using planemap_lcm::plane_lookup_t;
using planemap_lcm::reply_t;

void copy(const Eigen::Vector3d& from, double (&to)[3]) {
  std::copy_n(from.data(), 3, to);
}

planemap_lcm::plane_t plane_of(const DescribedPlane& plane) {
  return to_wire(*plane.record, *plane.outline, plane.plane_class);
}

planemap_lcm::near_plane_t near_plane_of(const NearPlane& plane, std::size_t point) {
  planemap_lcm::near_plane_t wire{};
  wire.point = static_cast<std::int32_t>(point);
  wire.plane_id = static_cast<std::int64_t>(plane.id);
  wire.surface_distance_m = plane.surface_distance_m;
  copy(plane.surface_point_m, wire.surface_point_m);
  wire.signed_distance_m = plane.signed_distance_m;
  wire.sigma_m = plane.sigma_m;
  wire.mahalanobis = plane.mahalanobis;
  copy(plane.foot_m, wire.foot_m);
  wire.foot_inside = plane.foot_inside ? 1 : 0;
  return wire;
}

planemap_lcm::plane_hit_t plane_hit_of(const PlaneHit& hit, std::size_t ray) {
  planemap_lcm::plane_hit_t wire{};
  wire.ray = static_cast<std::int32_t>(ray);
  wire.plane_id = static_cast<std::int64_t>(hit.id);
  wire.range_m = hit.range_m;
  wire.sigma_m = hit.sigma_m;
  wire.incidence_rad = hit.incidence_rad;
  wire.from_behind = hit.from_behind ? 1 : 0;
  copy(hit.point_m, wire.point_m);
  return wire;
}

planemap_lcm::cell_hit_t cell_hit_of(const CellHit& hit, std::size_t ray) {
  planemap_lcm::cell_hit_t wire{};
  wire.ray = static_cast<std::int32_t>(ray);
  wire.cell = to_wire(hit.cell);
  wire.entry_m = hit.entry_m;
  wire.range_m = hit.range_m;
  wire.sigma_m = hit.sigma_m;
  wire.incidence_rad = hit.incidence_rad.value_or(-1.0);
  return wire;
}

planemap_lcm::region_plane_t region_plane_of(const RegionPlane& plane) {
  planemap_lcm::region_plane_t wire{};
  wire.plane = plane_of(plane.plane);
  wire.whole = plane.whole ? 1 : 0;
  wire.clipped_area_m2 = plane.area_m2;
  for (const Polygon& polygon : plane.polygons) wire.clipped.push_back(to_wire(polygon));
  wire.n_clipped = static_cast<std::int32_t>(wire.clipped.size());
  return wire;
}

std::int8_t fate_of(PlaneFate fate) {
  switch (fate) {
    case PlaneFate::kLives:
      return plane_lookup_t::FATE_LIVES;
    case PlaneFate::kMerged:
      return plane_lookup_t::FATE_MERGED;
    case PlaneFate::kGone:
      return plane_lookup_t::FATE_GONE;
    case PlaneFate::kUnknown:
      break;
  }
  return plane_lookup_t::FATE_UNKNOWN;
}

void copy_ids(const std::vector<PlaneId>& from, std::int32_t& count, std::vector<std::int64_t>& to) {
  to.assign(from.begin(), from.end());
  count = static_cast<std::int32_t>(to.size());
}

void add_polygons(reply_t& reply, const std::vector<Polygon>& polygons, std::int8_t kind) {
  for (const Polygon& polygon : polygons) {
    plan_polygon_t wire{};
    wire.kind = kind;
    wire.polygon = to_wire(polygon);
    reply.plan_polygons.push_back(std::move(wire));
  }
}

}  // namespace

void add_to(reply_t& reply, const DescribedPlane& plane) {
  reply.planes.push_back(plane_of(plane));
}

void add_to(reply_t& reply, std::span<const NearPlane> planes, std::size_t point) {
  for (const NearPlane& plane : planes) reply.near_planes.push_back(near_plane_of(plane, point));
}

void add_to(reply_t& reply, std::span<const RayHits> hits) {
  for (std::size_t ray = 0; ray < hits.size(); ++ray) {
    if (hits[ray].plane) reply.plane_hits.push_back(plane_hit_of(*hits[ray].plane, ray));
    if (hits[ray].cell) reply.cell_hits.push_back(cell_hit_of(*hits[ray].cell, ray));
  }
}

void add_to(reply_t& reply, const RegionContents& contents) {
  for (const RegionPlane& plane : contents.planes) reply.region_planes.push_back(region_plane_of(plane));
  for (const CellView& cell : contents.cells) reply.cells.push_back(to_wire(cell));
}

void add_to(reply_t& reply, const PlaneLookup& lookup) {
  plane_lookup_t wire{};
  wire.asked = static_cast<std::int64_t>(lookup.asked);
  wire.fate = fate_of(lookup.fate);
  wire.removed_revision = lookup.removed_revision ? static_cast<std::int64_t>(*lookup.removed_revision) : -1;
  copy_ids(lookup.lineage, wire.n_lineage, wire.lineage);
  if (lookup.details) {
    wire.normal_deviation_rad = lookup.details->normal_deviation_rad;
    copy_ids(lookup.details->coplanar, wire.n_coplanar, wire.coplanar);
    copy_ids(lookup.details->plane.record->merged, wire.n_merged, wire.merged);
    add_to(reply, lookup.details->plane);
  }
  reply.lookups.push_back(std::move(wire));
}

void add_to(reply_t& reply, const Floorplan& plan) {
  planemap_lcm::floorplan_t wire{};
  copy(plan.axes.axis_x, wire.axis_x);
  copy(plan.axes.axis_y, wire.axis_y);
  copy(plan.axes.up, wire.up);
  wire.floor_height_m = plan.floor_height_m;
  wire.free_area_m2 = plan.free_area_m2;
  reply.floorplans.push_back(wire);
  add_polygons(reply, plan.walls, plan_polygon_t::KIND_WALL);
  add_polygons(reply, plan.floor, plan_polygon_t::KIND_FLOOR);
  add_polygons(reply, plan.free_floor, plan_polygon_t::KIND_FREE_FLOOR);
}

}  // namespace planemap::service

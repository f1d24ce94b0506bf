#include "lcm/query_answers.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "lcm/wire_types.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::plan_polygon_t;
using planemap_lcm::plane_lookup_t;
using planemap_lcm::reply_t;

tl::unexpected<Error> malformed(const char* what) {
  return tl::make_unexpected(Error{Error::Kind::kMalformed, std::string("the service's answer ") + what});
}

/// The only item of a list that is on one of the pages; nullptr: on none.
template <class Item>
const Item* only_item(const Replies& pages, std::vector<Item> reply_t::*list) {
  for (const reply_t& page : pages) {
    if (!(page.*list).empty()) return &(page.*list).front();
  }
  return nullptr;
}

NearPlane near_plane_of(const planemap_lcm::near_plane_t& wire) {
  return {wire.plane_id, wire.surface_distance_m, vector3_of(wire.surface_point_m), wire.signed_distance_m,
          wire.sigma_m,  wire.mahalanobis,        vector3_of(wire.foot_m),          wire.foot_inside != 0};
}

PlaneHit plane_hit_of(const planemap_lcm::plane_hit_t& wire) {
  return {wire.plane_id,      wire.range_m,          wire.sigma_m,
          wire.incidence_rad, wire.from_behind != 0, vector3_of(wire.point_m)};
}

CellHit cell_hit_of(const planemap_lcm::cell_hit_t& wire) {
  CellHit hit{cell_of(wire.cell), wire.entry_m, wire.range_m, wire.sigma_m, {}};
  if (wire.incidence_rad >= 0.0) hit.incidence_rad = wire.incidence_rad;
  return hit;
}

RegionPlane region_plane_of(const planemap_lcm::region_plane_t& wire) {
  RegionPlane plane{plane_of(wire.plane), wire.whole != 0, {}, wire.clipped_area_m2};
  std::transform(wire.clipped.begin(), wire.clipped.end(), std::back_inserter(plane.clipped), polygon_of);
  return plane;
}

PlaneFate fate_of(std::int8_t wire) {
  switch (wire) {
    case plane_lookup_t::FATE_LIVES:
      return PlaneFate::kLives;
    case plane_lookup_t::FATE_MERGED:
      return PlaneFate::kMerged;
    case plane_lookup_t::FATE_GONE:
      return PlaneFate::kGone;
    default:
      return PlaneFate::kUnknown;
  }
}

void add_polygon(const plan_polygon_t& wire, FloorplanAnswer& plan) {
  auto& polygons = wire.kind == plan_polygon_t::KIND_WALL    ? plan.walls
                   : wire.kind == plan_polygon_t::KIND_FLOOR ? plan.floor
                                                             : plan.free_floor;
  polygons.push_back(polygon_of(wire.polygon));
}

}  // namespace

MapVersion version_of(const Replies& pages) {
  return {pages.front().epoch, pages.front().revision};
}

Expected<Status> status_of_pages(const Replies& pages) {
  const auto* status = only_item(pages, &reply_t::service_status);
  if (status == nullptr) return malformed("holds no status");
  return status_of(*status);
}

Expected<void> add_nearest(const Replies& pages, std::size_t count, NearestAnswer& answer) {
  const std::size_t first = answer.points.size();
  answer.version = version_of(pages);
  answer.points.resize(first + count);
  for (const reply_t& page : pages) {
    for (const auto& near : page.near_planes) {
      if (static_cast<std::size_t>(near.point) >= count) return malformed("names a point that was not asked for");
      answer.points[first + static_cast<std::size_t>(near.point)].push_back(near_plane_of(near));
    }
  }
  return {};
}

Expected<void> add_hits(const Replies& pages, std::size_t count, CastAnswer& answer) {
  const std::size_t first = answer.rays.size();
  answer.version = version_of(pages);
  answer.rays.resize(first + count);
  for (const reply_t& page : pages) {
    for (const auto& hit : page.plane_hits) {
      if (static_cast<std::size_t>(hit.ray) >= count) return malformed("names a ray that was not asked for");
      answer.rays[first + static_cast<std::size_t>(hit.ray)].plane = plane_hit_of(hit);
    }
    for (const auto& hit : page.cell_hits) {
      if (static_cast<std::size_t>(hit.ray) >= count) return malformed("names a ray that was not asked for");
      answer.rays[first + static_cast<std::size_t>(hit.ray)].cell = cell_hit_of(hit);
    }
  }
  return {};
}

RegionAnswer region_of_pages(const Replies& pages) {
  RegionAnswer answer;
  answer.version = version_of(pages);
  for (const reply_t& page : pages) {
    std::transform(page.region_planes.begin(), page.region_planes.end(), std::back_inserter(answer.planes),
                   region_plane_of);
    std::transform(page.cells.begin(), page.cells.end(), std::back_inserter(answer.cells), cell_of);
  }
  return answer;
}

Expected<PlaneAnswer> plane_of_pages(const Replies& pages) {
  const auto* lookup = only_item(pages, &reply_t::lookups);
  if (lookup == nullptr) return malformed("does not say what became of the plane");
  PlaneAnswer answer;
  answer.version = version_of(pages);
  answer.asked = lookup->asked;
  answer.fate = fate_of(lookup->fate);
  answer.lineage = lookup->lineage;
  if (lookup->removed_revision >= 0) answer.removed_revision = lookup->removed_revision;
  answer.normal_deviation_rad = lookup->normal_deviation_rad;
  answer.coplanar = lookup->coplanar;
  answer.merged = lookup->merged;
  if (const auto* plane = only_item(pages, &reply_t::planes)) answer.plane = plane_of(*plane);
  const bool is_there = answer.fate == PlaneFate::kLives || answer.fate == PlaneFate::kMerged;
  if (is_there != answer.plane.has_value()) return malformed("contradicts itself about the plane");
  return answer;
}

Expected<FloorplanAnswer> floorplan_of_pages(const Replies& pages) {
  const auto* wire = only_item(pages, &reply_t::floorplans);
  if (wire == nullptr) return malformed("holds no floor plan");
  FloorplanAnswer plan;
  plan.version = version_of(pages);
  plan.axis_x = vector3_of(wire->axis_x);
  plan.axis_y = vector3_of(wire->axis_y);
  plan.up = vector3_of(wire->up);
  plan.floor_height_m = wire->floor_height_m;
  plan.free_area_m2 = wire->free_area_m2;
  for (const reply_t& page : pages) {
    for (const auto& polygon : page.plan_polygons) add_polygon(polygon, plan);
  }
  return plan;
}

}  // namespace planemap::client

#include "lcm/message_checks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace planemap::client {
namespace {

using planemap_lcm::cell_t;
using planemap_lcm::plane_t;
using planemap_lcm::polygon_t;
using planemap_lcm::reply_t;

template <class Numbers>
bool all_finite(const Numbers& numbers) {
  return std::all_of(std::begin(numbers), std::end(numbers), [](auto number) { return std::isfinite(number); });
}

bool polygons_are_sound(const std::vector<polygon_t>& polygons) {
  return std::all_of(polygons.begin(), polygons.end(), [](const polygon_t& polygon) { return is_sound(polygon); });
}

}  // namespace

bool is_sound(const polygon_t& polygon) {
  std::int64_t vertices = 0;
  for (const std::int32_t size : polygon.ring_size) {
    if (size < 3) return false;
    vertices += size;
  }
  return polygon.n_rings >= 1 && 2 * vertices == polygon.n_values && all_finite(polygon.uv_m);
}

bool is_sound(const plane_t& plane) {
  return all_finite(plane.normal) && std::isfinite(plane.d) && all_finite(plane.covariance) &&
         all_finite(plane.centroid_m) && std::isfinite(plane.area_m2) && all_finite(plane.origin_m) &&
         all_finite(plane.axis_u) && all_finite(plane.axis_v) && plane.id > 0 && polygons_are_sound(plane.polygons);
}

bool is_sound(const cell_t& cell) {
  return all_finite(cell.centre_m) && all_finite(cell.sigma_m) && all_finite(cell.normal) && cell.count >= 0;
}

bool is_sound(const planemap_lcm::near_plane_t& near) {
  // The Mahalanobis distance of what is known exactly is infinite.
  return near.point >= 0 && near.plane_id > 0 && std::isfinite(near.surface_distance_m) &&
         all_finite(near.surface_point_m) && std::isfinite(near.signed_distance_m) && std::isfinite(near.sigma_m) &&
         !std::isnan(near.mahalanobis) && all_finite(near.foot_m);
}

bool is_sound(const planemap_lcm::plane_hit_t& hit) {
  return hit.ray >= 0 && hit.plane_id > 0 && std::isfinite(hit.range_m) && std::isfinite(hit.sigma_m) &&
         std::isfinite(hit.incidence_rad) && all_finite(hit.point_m);
}

bool is_sound(const planemap_lcm::cell_hit_t& hit) {
  return hit.ray >= 0 && is_sound(hit.cell) && std::isfinite(hit.entry_m) && std::isfinite(hit.range_m) &&
         std::isfinite(hit.sigma_m) && std::isfinite(hit.incidence_rad);
}

bool is_sound(const planemap_lcm::region_plane_t& plane) {
  return is_sound(plane.plane) && std::isfinite(plane.clipped_area_m2) && polygons_are_sound(plane.clipped);
}

bool is_sound(const planemap_lcm::floorplan_t& plan) {
  return all_finite(plan.axis_x) && all_finite(plan.axis_y) && all_finite(plan.up) &&
         std::isfinite(plan.floor_height_m) && std::isfinite(plan.free_area_m2);
}

bool is_sound(const planemap_lcm::plan_polygon_t& polygon) {
  return polygon.kind >= planemap_lcm::plan_polygon_t::KIND_WALL &&
         polygon.kind <= planemap_lcm::plan_polygon_t::KIND_FREE_FLOOR && is_sound(polygon.polygon);
}

bool is_sound(const planemap_lcm::plane_lookup_t& lookup) {
  return lookup.fate >= planemap_lcm::plane_lookup_t::FATE_UNKNOWN &&
         lookup.fate <= planemap_lcm::plane_lookup_t::FATE_GONE && std::isfinite(lookup.normal_deviation_rad);
}

namespace {

template <class Item>
bool all_sound(const std::vector<Item>& items) {
  return std::all_of(items.begin(), items.end(), [](const Item& item) { return is_sound(item); });
}

}  // namespace

const char* unsound_part(const reply_t& reply) {
  if (reply.n_status > 1 || reply.n_lookups > 1 || reply.n_floorplans > 1) return "it holds more than one status";
  if (!all_sound(reply.planes) || !all_sound(reply.region_planes)) return "a plane's numbers are not sound";
  if (!all_sound(reply.cells)) return "a cell's numbers are not sound";
  if (!all_sound(reply.near_planes)) return "a near plane's numbers are not sound";
  if (!all_sound(reply.plane_hits) || !all_sound(reply.cell_hits)) return "a hit's numbers are not sound";
  if (!all_sound(reply.lookups)) return "a plane's lineage is not sound";
  if (!all_sound(reply.floorplans) || !all_sound(reply.plan_polygons)) return "a floor plan's numbers are not sound";
  return nullptr;
}

}  // namespace planemap::client

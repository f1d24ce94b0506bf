#include "codec/proto_answer_codec.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "codec/proto_parts.hpp"

namespace planemap::service {
namespace {

v1::PlaneFate fate_of(PlaneFate fate) {
  switch (fate) {
    case PlaneFate::kLives:
      return v1::PLANE_FATE_LIVES;
    case PlaneFate::kMerged:
      return v1::PLANE_FATE_MERGED;
    case PlaneFate::kGone:
      return v1::PLANE_FATE_GONE;
    case PlaneFate::kUnknown:
      break;
  }
  return v1::PLANE_FATE_UNSPECIFIED;
}

void set_hit(v1::PlaneHit& message, const PlaneHit& hit) {
  message.set_plane_id(hit.id);
  message.set_range_m(hit.range_m);
  message.set_sigma_m(hit.sigma_m);
  message.set_incidence_rad(hit.incidence_rad);
  message.set_from_behind(hit.from_behind);
  set(*message.mutable_point_m(), hit.point_m);
}

void set_hit(v1::CellHit& message, const CellHit& hit) {
  *message.mutable_cell() = to_proto(hit.cell);
  message.set_entry_m(hit.entry_m);
  message.set_range_m(hit.range_m);
  message.set_sigma_m(hit.sigma_m);
  if (hit.incidence_rad) message.set_incidence_rad(*hit.incidence_rad);
}

/// The least corner of all polygons: floats count from there.
Eigen::Vector2d least_corner(std::initializer_list<std::span<const Polygon>> lists) {
  Eigen::Vector2d least = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  for (const auto& polygons : lists) {
    for (const Polygon& polygon : polygons) {
      for (const Eigen::Vector2d& corner : polygon.outer) least = least.cwiseMin(corner);
    }
  }
  return least.allFinite() ? least : Eigen::Vector2d::Zero();
}

Polygon moved(Polygon polygon, const Eigen::Vector2d& by) {
  for (Eigen::Vector2d& corner : polygon.outer) corner += by;
  for (Ring& hole : polygon.holes) {
    for (Eigen::Vector2d& corner : hole) corner += by;
  }
  return polygon;
}

}  // namespace

v1::MapVersion version_of(const MapSnapshot& snapshot) {
  v1::MapVersion message;
  message.set_epoch(snapshot.epoch());
  message.set_revision(snapshot.revision());
  message.set_utime(snapshot.utime());
  return message;
}

v1::Plane to_proto(const DescribedPlane& plane) {
  return to_proto(*plane.record, plane.plane_class, *plane.outline);
}

v1::Cell to_proto(const CellView& cell) {
  v1::Cell message;
  message.set_index_x(cell.index.x());
  message.set_index_y(cell.index.y());
  message.set_index_z(cell.index.z());
  set(*message.mutable_centre_m(), cell.centre_m);
  set(*message.mutable_sigma_m(), cell.sigma_m);
  if (cell.normal) set(*message.mutable_normal(), *cell.normal);
  message.set_deviation_rad(static_cast<float>(cell.deviation_rad));
  message.set_count(cell.count);
  message.set_plane_id(cell.plane_id);
  return message;
}

v1::RemovedPlane to_proto(const RemovedPlane& removed) {
  v1::RemovedPlane message;
  message.set_id(removed.id);
  message.set_merged_into(removed.merged_into);
  message.set_revision(removed.revision);
  return message;
}

v1::NearPlane to_proto(const NearPlane& plane) {
  v1::NearPlane message;
  message.set_plane_id(plane.id);
  message.set_surface_distance_m(plane.surface_distance_m);
  set(*message.mutable_surface_point_m(), plane.surface_point_m);
  message.set_signed_distance_m(plane.signed_distance_m);
  message.set_sigma_m(plane.sigma_m);
  message.set_mahalanobis(plane.mahalanobis);
  set(*message.mutable_foot_m(), plane.foot_m);
  message.set_foot_inside(plane.foot_inside);
  return message;
}

v1::RayHits to_proto(const RayHits& hits) {
  v1::RayHits message;
  if (hits.plane) set_hit(*message.mutable_plane(), *hits.plane);
  if (hits.cell) set_hit(*message.mutable_cell(), *hits.cell);
  return message;
}

v1::RegionPlane to_proto(const RegionPlane& plane) {
  v1::RegionPlane message;
  *message.mutable_plane() = to_proto(plane.plane);
  message.set_whole(plane.whole);
  message.set_area_m2(plane.area_m2);
  for (const Polygon& polygon : plane.polygons) set(*message.add_polygons(), polygon);
  return message;
}

v1::GetPlaneResponse to_proto(const PlaneLookup& lookup) {
  v1::GetPlaneResponse message;
  message.set_fate(fate_of(lookup.fate));
  for (const PlaneId id : lookup.lineage) message.add_lineage(id);
  if (lookup.removed_revision) message.set_removed_revision(*lookup.removed_revision);
  if (!lookup.details) return message;
  *message.mutable_plane() = to_proto(lookup.details->plane);
  message.set_normal_deviation_rad(lookup.details->normal_deviation_rad);
  for (const PlaneId id : lookup.details->coplanar) message.add_coplanar(id);
  return message;
}

v1::GetFloorPlanResponse to_proto(const Floorplan& plan) {
  v1::GetFloorPlanResponse message;
  const Eigen::Vector2d least = least_corner({plan.walls, plan.floor, plan.free_floor});
  set(*message.mutable_origin_m(),
      least.x() * plan.axes.axis_x + least.y() * plan.axes.axis_y + plan.floor_height_m * plan.axes.up);
  set(*message.mutable_axis_x(), plan.axes.axis_x);
  set(*message.mutable_axis_y(), plan.axes.axis_y);
  for (const Polygon& polygon : plan.walls) set(*message.add_walls(), moved(polygon, -least));
  for (const Polygon& polygon : plan.floor) set(*message.add_floor(), moved(polygon, -least));
  for (const Polygon& polygon : plan.free_floor) set(*message.add_free_floor(), moved(polygon, -least));
  message.set_free_area_m2(plan.free_area_m2);
  return message;
}

bool cut_to_fit(v1::Plane& plane, std::size_t max_bytes) {
  bool is_cut = false;
  auto& polygons = *plane.mutable_outline()->mutable_polygons();
  while (plane.ByteSizeLong() > max_bytes && !polygons.empty()) {
    auto& holes = *polygons.Mutable(polygons.size() - 1)->mutable_holes();
    // Half of what is left at a time: each step reads all of the message.
    if (polygons.size() > 1) {
      polygons.DeleteSubrange(polygons.size() - polygons.size() / 2, polygons.size() / 2);
    } else if (!holes.empty()) {
      holes.DeleteSubrange(holes.size() / 2, holes.size() - holes.size() / 2);
    } else {
      polygons.Clear();
    }
    is_cut = true;
  }
  return is_cut;
}

}  // namespace planemap::service

#include "proto_questions.hpp"

#include <algorithm>
#include <variant>

namespace planemap::client {
namespace {

void set(v1::Vector3& message, const Vector3& v) {
  message.set_x(v[0]);
  message.set_y(v[1]);
  message.set_z(v[2]);
}

v1::PlaneClass class_named(const std::string& name) {
  if (name == "floor") return v1::PLANE_CLASS_FLOOR;
  if (name == "ceiling") return v1::PLANE_CLASS_CEILING;
  if (name == "wall") return v1::PLANE_CLASS_WALL;
  if (name == "table") return v1::PLANE_CLASS_TABLE;
  if (name == "slope") return v1::PLANE_CLASS_SLOPE;
  return v1::PLANE_CLASS_OTHER;
}

void set(v1::PlaneFilter& message, const PlaneFilter& filter) {
  for (const std::string& name : filter.classes) message.add_classes(class_named(name));
  message.set_min_area_m2(filter.min_area_m2);
  if (filter.max_normal_deviation_rad != kNoLimit) {
    message.set_max_normal_deviation_rad(filter.max_normal_deviation_rad);
  }
  if (filter.seen_since_utime != 0) message.set_seen_since_utime(filter.seen_since_utime);
  message.set_epoch(static_cast<std::uint64_t>(filter.epoch));
}

void set(v1::NearestPoint& message, const QueryPoint& point) {
  set(*message.mutable_point_m(), point.point_m);
  const auto& c = point.covariance_m2;
  if (std::all_of(c.begin(), c.end(), [](double element) { return element == 0.0; })) {
    message.set_sigma_m(point.sigma_m);
    return;
  }
  const double variance_m2 = point.sigma_m * point.sigma_m;
  for (const double element : {c[0] + variance_m2, c[1], c[2], c[4] + variance_m2, c[5], c[8] + variance_m2}) {
    message.add_covariance_m2(element);
  }
}

void set(v1::Pose& message, const Pose& pose) {
  set(*message.mutable_position_m(), pose.position_m);
  message.set_rotation_w(pose.rotation_wxyz[0]);
  message.set_rotation_x(pose.rotation_wxyz[1]);
  message.set_rotation_y(pose.rotation_wxyz[2]);
  message.set_rotation_z(pose.rotation_wxyz[3]);
}

void set_shape(v1::QueryRegionRequest& message, const Box& box) {
  set(*message.mutable_box()->mutable_min_m(), box.min_m);
  set(*message.mutable_box()->mutable_max_m(), box.max_m);
}

void set_shape(v1::QueryRegionRequest& message, const OrientedBox& box) {
  set(*message.mutable_oriented_box()->mutable_pose(), box.pose);
  set(*message.mutable_oriented_box()->mutable_size_m(), box.size_m);
}

void set_shape(v1::QueryRegionRequest& message, const Sphere& sphere) {
  set(*message.mutable_sphere()->mutable_centre_m(), sphere.centre_m);
  message.mutable_sphere()->set_radius_m(sphere.radius_m);
}

void set_shape(v1::QueryRegionRequest& message, const Frustum& frustum) {
  v1::Frustum& shape = *message.mutable_frustum();
  set(*shape.mutable_pose(), frustum.pose);
  shape.set_horizontal_rad(frustum.horizontal_rad);
  shape.set_vertical_rad(frustum.vertical_rad);
  shape.set_near_m(frustum.near_m);
  shape.set_far_m(frustum.far_m);
}

void set_shape(v1::QueryRegionRequest& message, const Cylinder& cylinder) {
  set(*message.mutable_cylinder()->mutable_from_m(), cylinder.from_m);
  set(*message.mutable_cylinder()->mutable_to_m(), cylinder.to_m);
  message.mutable_cylinder()->set_radius_m(cylinder.radius_m);
}

}  // namespace

v1::NearestPlanesRequest nearest_message(std::span<const QueryPoint> points, const NearestOptions& options) {
  v1::NearestPlanesRequest message;
  message.set_count(static_cast<std::uint32_t>(options.count));
  if (options.max_distance_m != kNoLimit) message.set_max_distance_m(options.max_distance_m);
  set(*message.mutable_filter(), options.filter);
  for (const QueryPoint& point : points) set(*message.add_points(), point);
  return message;
}

v1::CastRaysRequest rays_message(std::span<const Ray> rays, const CastOptions& options) {
  v1::CastRaysRequest message;
  message.set_skip_planes(!options.planes);
  message.set_skip_cells(!options.cells);
  set(*message.mutable_filter(), options.filter);
  for (const Ray& ray : rays) {
    v1::Ray& message_ray = *message.add_rays();
    set(*message_ray.mutable_origin_m(), ray.origin_m);
    set(*message_ray.mutable_direction(), ray.direction);
    if (ray.max_range_m != kNoLimit) message_ray.set_max_range_m(ray.max_range_m);
  }
  return message;
}

v1::QueryRegionRequest region_message(const RegionQuery& query) {
  v1::QueryRegionRequest message;
  std::visit([&](const auto& shape) { set_shape(message, shape); }, query.region);
  message.set_polygons(query.polygons);
  message.set_cells(query.cells);
  set(*message.mutable_filter(), query.filter);
  return message;
}

v1::GetFloorPlanRequest floorplan_message(const FloorplanQuery& query) {
  v1::GetFloorPlanRequest message;
  message.set_cut_low_m(query.cut_low_m);
  message.set_cut_high_m(query.cut_high_m);
  message.set_wall_thickness_m(query.wall_thickness_m);
  message.set_clear_low_m(query.clear_low_m);
  message.set_clear_high_m(query.clear_high_m);
  set(*message.mutable_filter(), query.filter);
  return message;
}

}  // namespace planemap::client

#include "lcm/query_requests.hpp"

#include <algorithm>
#include <array>
#include <variant>

namespace planemap::client {
namespace {

using planemap_lcm::region_query_t;
using planemap_lcm::request_t;

void copy(const Vector3& from, double (&to)[3]) {
  std::copy(from.begin(), from.end(), to);
}

/// The wire has 0 for "no limit"; limits of 0 were refused before.
double wire_limit(double limit) {
  return limit == kNoLimit ? 0.0 : limit;
}

planemap_lcm::filter_t wire_filter(const PlaneFilter& filter) {
  planemap_lcm::filter_t wire{};
  wire.epoch = filter.epoch;
  wire.min_area_m2 = filter.min_area_m2;
  wire.max_normal_deviation_rad = wire_limit(filter.max_normal_deviation_rad);
  wire.seen_since_utime = filter.seen_since_utime;
  wire.classes = filter.classes;
  wire.n_classes = static_cast<std::int32_t>(wire.classes.size());
  return wire;
}

planemap_lcm::query_point_t wire_point(const QueryPoint& point) {
  planemap_lcm::query_point_t wire{};
  copy(point.point_m, wire.point_m);
  wire.sigma_m = point.sigma_m;
  const auto& c = point.covariance_m2;
  const std::array<double, 6> upper = {c[0], c[1], c[2], c[4], c[5], c[8]};
  std::copy(upper.begin(), upper.end(), wire.covariance_m2);
  return wire;
}

void set_pose(const Pose& pose, region_query_t& wire) {
  copy(pose.position_m, wire.from_m);
  std::copy(pose.rotation_wxyz.begin(), pose.rotation_wxyz.end(), wire.rotation_wxyz);
}

void set_shape(const Box& box, region_query_t& wire) {
  wire.shape = region_query_t::SHAPE_BOX;
  copy(box.min_m, wire.from_m);
  copy(box.max_m, wire.to_m);
}

void set_shape(const OrientedBox& box, region_query_t& wire) {
  wire.shape = region_query_t::SHAPE_ORIENTED_BOX;
  set_pose(box.pose, wire);
  copy(box.size_m, wire.size_m);
}

void set_shape(const Sphere& sphere, region_query_t& wire) {
  wire.shape = region_query_t::SHAPE_SPHERE;
  copy(sphere.centre_m, wire.from_m);
  wire.radius_m = sphere.radius_m;
}

void set_shape(const Frustum& frustum, region_query_t& wire) {
  wire.shape = region_query_t::SHAPE_FRUSTUM;
  set_pose(frustum.pose, wire);
  wire.horizontal_rad = frustum.horizontal_rad;
  wire.vertical_rad = frustum.vertical_rad;
  wire.near_m = frustum.near_m;
  wire.far_m = frustum.far_m;
}

void set_shape(const Cylinder& cylinder, region_query_t& wire) {
  wire.shape = region_query_t::SHAPE_CYLINDER;
  copy(cylinder.from_m, wire.from_m);
  copy(cylinder.to_m, wire.to_m);
  wire.radius_m = cylinder.radius_m;
}

}  // namespace

request_t request_for(std::int16_t operation) {
  request_t request{};
  request.operation = operation;
  return request;
}

request_t nearest_request(std::span<const QueryPoint> points, const NearestOptions& options) {
  request_t request = request_for(request_t::OPERATION_NEAREST);
  request.filter = wire_filter(options.filter);
  planemap_lcm::nearest_query_t query{};
  query.count = options.count;
  query.max_distance_m = wire_limit(options.max_distance_m);
  query.points.reserve(points.size());
  for (const QueryPoint& point : points) query.points.push_back(wire_point(point));
  query.n_points = static_cast<std::int32_t>(query.points.size());
  request.nearest = {query};
  request.n_nearest = 1;
  return request;
}

request_t rays_request(std::span<const Ray> rays, const CastOptions& options) {
  request_t request = request_for(request_t::OPERATION_RAYS);
  request.filter = wire_filter(options.filter);
  planemap_lcm::rays_query_t query{};
  query.planes = options.planes ? 1 : 0;
  query.cells = options.cells ? 1 : 0;
  query.rays.reserve(rays.size());
  for (const Ray& ray : rays) {
    planemap_lcm::ray_t& wire = query.rays.emplace_back();
    copy(ray.origin_m, wire.origin_m);
    copy(ray.direction, wire.direction);
    wire.max_range_m = wire_limit(ray.max_range_m);
  }
  query.n_rays = static_cast<std::int32_t>(query.rays.size());
  request.rays = {query};
  request.n_rays = 1;
  return request;
}

request_t region_request(const RegionQuery& query) {
  request_t request = request_for(request_t::OPERATION_REGION);
  request.filter = wire_filter(query.filter);
  region_query_t wire{};
  std::visit([&](const auto& shape) { set_shape(shape, wire); }, query.region);
  wire.polygons = query.polygons ? 1 : 0;
  wire.cells = query.cells ? 1 : 0;
  request.region = {wire};
  request.n_region = 1;
  return request;
}

request_t plane_request(std::int64_t id) {
  request_t request = request_for(request_t::OPERATION_PLANE);
  planemap_lcm::plane_query_t query{};
  query.id = id;
  request.plane = {query};
  request.n_plane = 1;
  return request;
}

request_t floorplan_request(const FloorplanQuery& query) {
  request_t request = request_for(request_t::OPERATION_FLOORPLAN);
  request.filter = wire_filter(query.filter);
  planemap_lcm::floorplan_query_t wire{};
  wire.cut_low_m = query.cut_low_m;
  wire.cut_high_m = query.cut_high_m;
  wire.wall_thickness_m = query.wall_thickness_m;
  wire.clear_low_m = query.clear_low_m;
  wire.clear_high_m = query.clear_high_m;
  request.floorplan = {wire};
  request.n_floorplan = 1;
  return request;
}

}  // namespace planemap::client

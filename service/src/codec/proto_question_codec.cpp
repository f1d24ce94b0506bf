#include "codec/proto_question_codec.hpp"

#include <planemap/v1/queries.pb.h>
#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>

#include "codec/proto_parts.hpp"

namespace planemap::service {
namespace {

/// Quaternions that were written with three digits are taken and normalised; others are slips.
constexpr double kUnitTolerance = 1e-3;

Expected<Eigen::Matrix3d> covariance_of(const v1::NearestPoint& message) {
  if (message.covariance_m2().empty()) {
    const double sigma_m = message.sigma_m();
    if (!std::isfinite(sigma_m) || sigma_m < 0.0) {
      return fail(fmt::format("sigma_m: must be finite and at least 0, is {:g}", sigma_m));
    }
    return Eigen::Matrix3d(sigma_m * sigma_m * Eigen::Matrix3d::Identity());
  }
  if (message.covariance_m2_size() != 6) {
    return fail("covariance_m2: has " + std::to_string(message.covariance_m2_size()) +
                " numbers, must have 6 (xx xy xz yy yz zz), or none");
  }
  if (message.sigma_m() != 0.0) return fail("sigma_m: give it or covariance_m2, not both");
  const auto& c = message.covariance_m2();
  Eigen::Matrix3d covariance;
  covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return covariance;
}

Expected<Eigen::Isometry3d> isometry_of(const v1::Pose& message, const std::string& name) {
  const Eigen::Quaterniond rotation(message.rotation_w(), message.rotation_x(), message.rotation_y(),
                                    message.rotation_z());
  if (!rotation.coeffs().allFinite() || std::abs(rotation.norm() - 1.0) > kUnitTolerance) {
    return fail(
        fmt::format("{}.rotation_w, _x, _y, _z: must be a unit quaternion, its length is {:g}", name, rotation.norm()));
  }
  Eigen::Isometry3d pose(rotation.normalized());
  pose.translation() = vector_of(message.position_m());
  return pose;
}

tl::unexpected<Error> missing(const std::string& field) {
  return fail(field + ": is missing");
}

Expected<Region> region_of(const v1::Box& box) {
  if (!box.has_min_m() || !box.has_max_m()) return missing(box.has_min_m() ? "box.max_m" : "box.min_m");
  return BoxRegion{vector_of(box.min_m()), vector_of(box.max_m())};
}

Expected<Region> region_of(const v1::OrientedBox& box) {
  if (!box.has_pose()) return missing("oriented_box.pose");
  auto pose = isometry_of(box.pose(), "oriented_box.pose");
  if (!pose) return tl::make_unexpected(pose.error());
  return OrientedBoxRegion{*pose, vector_of(box.size_m())};
}

Expected<Region> region_of(const v1::Frustum& frustum) {
  if (!frustum.has_pose()) return missing("frustum.pose");
  auto pose = isometry_of(frustum.pose(), "frustum.pose");
  if (!pose) return tl::make_unexpected(pose.error());
  return FrustumRegion{*pose, frustum.horizontal_rad(), frustum.vertical_rad(), frustum.near_m(), frustum.far_m()};
}

Expected<Region> region_of(const v1::Cylinder& cylinder) {
  return CylinderRegion{vector_of(cylinder.from_m()), vector_of(cylinder.to_m()), cylinder.radius_m()};
}

Expected<Region> region_of(const v1::QueryRegionRequest& message) {
  switch (message.region_case()) {
    case v1::QueryRegionRequest::kBox:
      return region_of(message.box());
    case v1::QueryRegionRequest::kOrientedBox:
      return region_of(message.oriented_box());
    case v1::QueryRegionRequest::kSphere:
      return SphereRegion{vector_of(message.sphere().centre_m()), message.sphere().radius_m()};
    case v1::QueryRegionRequest::kFrustum:
      return region_of(message.frustum());
    case v1::QueryRegionRequest::kCylinder:
      return region_of(message.cylinder());
    case v1::QueryRegionRequest::REGION_NOT_SET:
      break;
  }
  return fail("region: is missing (box, oriented_box, sphere, frustum or cylinder)");
}

/// How many planes are asked for at each point.
Expected<std::size_t> count_of(const v1::NearestPlanesRequest& message) {
  const auto points = static_cast<std::size_t>(message.points_size());
  if (points == 0) return missing("points");
  const std::size_t count = message.count() == 0 ? 1 : message.count();
  if (count > kMaxNearestPlanes || points * count > kMaxNearestPlanes) {
    return fail("points: " + std::to_string(points) + " points with " + std::to_string(count) +
                " planes each are more than " + std::to_string(kMaxNearestPlanes) +
                " planes in all; ask in smaller batches");
  }
  return count;
}

}  // namespace

Expected<PlaneFilter> to_filter(const v1::PlaneFilter& message) {
  PlaneFilter filter;
  filter.classes.reserve(static_cast<std::size_t>(message.classes_size()));
  for (const int number : message.classes()) {
    const auto plane_class = class_of(static_cast<v1::PlaneClass>(number));
    if (!plane_class) return fail("filter.classes: " + std::to_string(number) + " is no class");
    filter.classes.push_back(*plane_class);
  }
  filter.min_area_m2 = message.min_area_m2();
  if (message.has_max_normal_deviation_rad()) filter.max_normal_deviation_rad = message.max_normal_deviation_rad();
  if (message.has_seen_since_utime()) filter.seen_since_utime = message.seen_since_utime();
  if (message.epoch() != 0) filter.epoch = message.epoch();
  return filter;
}

Expected<std::vector<NearestQuery>> to_queries(const v1::NearestPlanesRequest& message) {
  const auto count = count_of(message);
  if (!count) return tl::make_unexpected(count.error());
  auto filter = to_filter(message.filter());
  if (!filter) return tl::make_unexpected(filter.error());
  std::vector<NearestQuery> queries;
  queries.reserve(static_cast<std::size_t>(message.points_size()));
  for (int i = 0; i < message.points_size(); ++i) {
    const v1::NearestPoint& point = message.points(i);
    const std::string name = "points[" + std::to_string(i) + "].";
    if (!point.has_point_m()) return missing(name + "point_m");
    auto covariance = covariance_of(point);
    if (!covariance) return fail(name + covariance.error().message);
    NearestQuery query;
    query.point_m = vector_of(point.point_m());
    query.covariance_m2 = *covariance;
    query.count = *count;
    if (message.has_max_distance_m()) query.max_distance_m = message.max_distance_m();
    query.filter = *filter;
    queries.push_back(std::move(query));
  }
  return queries;
}

Expected<RayQuery> to_query(const v1::CastRaysRequest& message) {
  const auto count = static_cast<std::size_t>(message.rays_size());
  if (count == 0) return missing("rays");
  if (count > kMaxRays) {
    return fail("rays: " + std::to_string(count) + " are more than " + std::to_string(kMaxRays) +
                "; ask in smaller batches");
  }
  if (message.skip_planes() && message.skip_cells()) return fail("skip_cells: with skip_planes nothing is left");
  auto filter = to_filter(message.filter());
  if (!filter) return tl::make_unexpected(filter.error());
  RayQuery query;
  query.options = {!message.skip_planes(), !message.skip_cells(), std::move(*filter)};
  query.rays.reserve(count);
  for (const v1::Ray& message_ray : message.rays()) {
    Ray ray;
    ray.origin_m = vector_of(message_ray.origin_m());
    ray.direction = vector_of(message_ray.direction());
    if (message_ray.has_max_range_m()) ray.max_range_m = message_ray.max_range_m();
    query.rays.push_back(ray);
  }
  return query;
}

Expected<RegionQuery> to_query(const v1::QueryRegionRequest& message) {
  auto region = region_of(message);
  if (!region) return tl::make_unexpected(region.error());
  auto filter = to_filter(message.filter());
  if (!filter) return tl::make_unexpected(filter.error());
  return RegionQuery{std::move(*region), message.polygons(), message.cells(), std::move(*filter)};
}

Expected<FloorplanQuery> to_query(const v1::GetFloorPlanRequest& message) {
  auto filter = to_filter(message.filter());
  if (!filter) return tl::make_unexpected(filter.error());
  FloorplanQuery query;
  if (message.has_cut_low_m()) query.cut_low_m = message.cut_low_m();
  if (message.has_cut_high_m()) query.cut_high_m = message.cut_high_m();
  if (message.has_wall_thickness_m()) query.wall_thickness_m = message.wall_thickness_m();
  if (message.has_clear_low_m()) query.clear_low_m = message.clear_low_m();
  if (message.has_clear_high_m()) query.clear_high_m = message.clear_high_m();
  query.filter = std::move(*filter);
  return query;
}

}  // namespace planemap::service

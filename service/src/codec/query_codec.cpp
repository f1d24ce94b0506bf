#include "codec/query_codec.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace planemap::service {
namespace {

using planemap_lcm::region_query_t;

constexpr std::size_t kMostClasses = 16;
constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length; poses are held to the same
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

constexpr std::array kClasses = {PlaneClass::kFloor, PlaneClass::kCeiling, PlaneClass::kWall,
                                 PlaneClass::kTable, PlaneClass::kSlope,   PlaneClass::kOther};

Eigen::Vector3d vector_of(const double (&wire)[3]) {
  return {wire[0], wire[1], wire[2]};
}

/// 0 stands for no limit.
double limit_of(double wire) {
  return wire == 0.0 ? kNoLimit : wire;
}

Expected<PlaneClass> class_named(const std::string& name) {
  const auto found = std::find_if(kClasses.begin(), kClasses.end(), [&](PlaneClass c) { return name_of(c) == name; });
  if (found != kClasses.end()) return *found;
  return fail(fmt::format("filter.classes: '{}' is no class (floor, ceiling, wall, table, slope, other)",
                          std::string_view(name).substr(0, 32)));
}

Expected<Eigen::Matrix3d> covariance_of(const planemap_lcm::query_point_t& wire, std::size_t number) {
  if (!std::isfinite(wire.sigma_m) || wire.sigma_m < 0.0) {
    return fail(fmt::format("points[{}].sigma_m: must be finite and at least 0, is {}", number, wire.sigma_m));
  }
  const double* c = wire.covariance_m2;
  Eigen::Matrix3d covariance_m2;
  covariance_m2 << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  covariance_m2.diagonal().array() += wire.sigma_m * wire.sigma_m;
  return covariance_m2;
}

Expected<Eigen::Isometry3d> pose_of(const region_query_t& wire, const char* shape) {
  const double* q = wire.rotation_wxyz;
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  const double length = rotation.norm();
  if (!(std::abs(length - 1.0) <= kUnitTolerance)) {
    return fail(fmt::format("{}.rotation_wxyz: must be a unit quaternion, its length is {:g}", shape, length));
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = vector_of(wire.from_m);
  return pose;
}

Expected<Region> region_of(const region_query_t& wire) {
  switch (wire.shape) {
    case region_query_t::SHAPE_BOX:
      return BoxRegion{vector_of(wire.from_m), vector_of(wire.to_m)};
    case region_query_t::SHAPE_ORIENTED_BOX:
      return pose_of(wire, "oriented_box").map([&](const Eigen::Isometry3d& pose) -> Region {
        return OrientedBoxRegion{pose, vector_of(wire.size_m)};
      });
    case region_query_t::SHAPE_SPHERE:
      return SphereRegion{vector_of(wire.from_m), wire.radius_m};
    case region_query_t::SHAPE_FRUSTUM:
      return pose_of(wire, "frustum").map([&](const Eigen::Isometry3d& pose) -> Region {
        return FrustumRegion{pose, wire.horizontal_rad, wire.vertical_rad, wire.near_m, wire.far_m};
      });
    case region_query_t::SHAPE_CYLINDER:
      return CylinderRegion{vector_of(wire.from_m), vector_of(wire.to_m), wire.radius_m};
    default:
      return fail(fmt::format("shape: {} is none (1 box, 2 oriented box, 3 sphere, 4 frustum, 5 cylinder)",
                              static_cast<int>(wire.shape)));
  }
}

Expected<void> check_batch(const char* name, std::size_t size, std::size_t most) {
  if (size >= 1 && size <= most) return {};
  return fail(fmt::format("{}: there must be 1 to {} in a request, there are {}", name, most, size));
}

}  // namespace

Expected<PlaneFilter> to_filter(const planemap_lcm::filter_t& wire) {
  if (wire.epoch < 0) return fail(fmt::format("filter.epoch: must be at least 0, is {}", wire.epoch));
  if (wire.classes.size() > kMostClasses) {
    return fail(fmt::format("filter.classes: there may be {}, there are {}", kMostClasses, wire.classes.size()));
  }
  PlaneFilter filter;
  if (wire.epoch > 0) filter.epoch = static_cast<std::uint64_t>(wire.epoch);
  filter.min_area_m2 = wire.min_area_m2;
  filter.max_normal_deviation_rad = limit_of(wire.max_normal_deviation_rad);
  if (wire.seen_since_utime != 0) filter.seen_since_utime = wire.seen_since_utime;
  for (const auto& name : wire.classes) {
    const auto plane_class = class_named(name);
    if (!plane_class) return tl::make_unexpected(plane_class.error());
    filter.classes.push_back(*plane_class);
  }
  return filter;
}

Expected<std::vector<NearestQuery>> to_queries(const planemap_lcm::nearest_query_t& wire, const PlaneFilter& filter) {
  if (auto size = check_batch("points", wire.points.size(), kMostPoints); !size) {
    return tl::make_unexpected(size.error());
  }
  if (wire.count < 1 || wire.count > kMostNearPlanes) {
    return fail(fmt::format("count: must be 1 to {}, is {}", kMostNearPlanes, wire.count));
  }
  std::vector<NearestQuery> queries;
  queries.reserve(wire.points.size());
  for (const auto& point : wire.points) {
    const auto covariance_m2 = covariance_of(point, queries.size());
    if (!covariance_m2) return tl::make_unexpected(covariance_m2.error());
    queries.push_back({vector_of(point.point_m), *covariance_m2, static_cast<std::size_t>(wire.count),
                       limit_of(wire.max_distance_m), filter});
  }
  return queries;
}

Expected<RaysQuery> to_query(const planemap_lcm::rays_query_t& wire, const PlaneFilter& filter) {
  if (auto size = check_batch("rays", wire.rays.size(), kMostRays); !size) return tl::make_unexpected(size.error());
  if (wire.planes == 0 && wire.cells == 0) return fail("planes, cells: one of them must be asked for");
  RaysQuery query;
  query.options = {wire.planes != 0, wire.cells != 0, filter};
  query.rays.reserve(wire.rays.size());
  for (const auto& ray : wire.rays) {
    query.rays.push_back({vector_of(ray.origin_m), vector_of(ray.direction), limit_of(ray.max_range_m)});
  }
  return query;
}

Expected<RegionQuery> to_query(const region_query_t& wire, const PlaneFilter& filter) {
  return region_of(wire).map([&](Region region) {
    return RegionQuery{std::move(region), wire.polygons != 0, wire.cells != 0, filter};
  });
}

FloorplanQuery to_query(const planemap_lcm::floorplan_query_t& wire, const PlaneFilter& filter) {
  return {wire.cut_low_m, wire.cut_high_m, wire.wall_thickness_m, wire.clear_low_m, wire.clear_high_m, filter};
}

}  // namespace planemap::service

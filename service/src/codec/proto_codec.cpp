#include "codec/proto_codec.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "codec/proto_parts.hpp"

namespace planemap::service {
namespace {

constexpr std::uint64_t kNumberLimit = std::uint64_t{1} << 53;  // what a double, and so JavaScript, counts exactly
constexpr double kUnitTolerance = 1e-6;
/// In the order of PlaneClass.
constexpr std::array<v1::PlaneClass, 6> kClasses = {v1::PLANE_CLASS_OTHER,   v1::PLANE_CLASS_FLOOR,
                                                    v1::PLANE_CLASS_CEILING, v1::PLANE_CLASS_WALL,
                                                    v1::PLANE_CLASS_TABLE,   v1::PLANE_CLASS_SLOPE};

void set_outline(v1::Outline& message, const Outline& outline) {
  set(*message.mutable_origin_m(), outline.basis.origin_m);
  set(*message.mutable_axis_u(), outline.basis.axis_u);
  set(*message.mutable_axis_v(), outline.basis.axis_v);
  message.set_area_m2(outline.area_m2);
  for (const Polygon& polygon : outline.polygons) set(*message.add_polygons(), polygon);
}

bool is_unit(const Eigen::Vector3d& v) {
  return v.allFinite() && std::abs(v.norm() - 1.0) <= kUnitTolerance;
}

Expected<Ring> ring_of(const v1::Ring& message) {
  if (message.uv_m_size() < 6 || message.uv_m_size() % 2 != 0) {
    return fail("a ring of " + std::to_string(message.uv_m_size()) + " numbers: it takes pairs, three at least");
  }
  Ring ring;
  ring.reserve(static_cast<std::size_t>(message.uv_m_size()) / 2);
  for (int i = 0; i < message.uv_m_size(); i += 2) {
    const Eigen::Vector2d uv_m(message.uv_m(i), message.uv_m(i + 1));
    if (!uv_m.allFinite()) return fail("a ring with a number that is not finite");
    ring.push_back(uv_m);
  }
  return ring;
}

Expected<Polygon> polygon_of(const v1::Polygon& message) {
  Polygon polygon;
  auto outer = ring_of(message.outer());
  if (!outer) return tl::make_unexpected(outer.error());
  polygon.outer = std::move(*outer);
  for (const v1::Ring& hole_message : message.holes()) {
    auto hole = ring_of(hole_message);
    if (!hole) return tl::make_unexpected(hole.error());
    polygon.holes.push_back(std::move(*hole));
  }
  return polygon;
}

Expected<Outline> outline_of_message(const v1::Outline& message, const Eigen::Vector3d& normal) {
  Outline outline;
  outline.basis = {vector_of(message.origin_m()), vector_of(message.axis_u()), vector_of(message.axis_v())};
  outline.area_m2 = message.area_m2();
  if (!outline.basis.origin_m.allFinite()) return fail("origin_m is not finite");
  if (!is_unit(outline.basis.axis_u) || !is_unit(outline.basis.axis_v)) return fail("an axis is not a unit vector");
  if (!outline.basis.axis_u.cross(outline.basis.axis_v).isApprox(normal, 2 * kUnitTolerance)) {
    return fail("axis_u x axis_v is not the normal");
  }
  if (!std::isfinite(outline.area_m2) || outline.area_m2 < 0.0) return fail("area_m2 is not a number >= 0");
  for (const v1::Polygon& polygon_message : message.polygons()) {
    auto polygon = polygon_of(polygon_message);
    if (!polygon) return tl::make_unexpected(polygon.error());
    outline.polygons.push_back(std::move(*polygon));
  }
  return outline;
}

void set_covariance(v1::Plane& message, const Eigen::Matrix4d& covariance) {
  for (int row = 0; row < 4; ++row) {
    for (int column = row; column < 4; ++column) message.add_covariance(covariance(row, column));
  }
}

Expected<Eigen::Matrix4d> covariance_of(const v1::Plane& message) {
  if (message.covariance_size() != 10) {
    return fail("covariance has " + std::to_string(message.covariance_size()) + " numbers, not 10");
  }
  Eigen::Matrix4d covariance;
  int next = 0;
  for (int row = 0; row < 4; ++row) {
    for (int column = row; column < 4; ++column) {
      covariance(row, column) = covariance(column, row) = message.covariance(next++);
    }
  }
  if (!covariance.allFinite()) return fail("covariance is not finite");
  if ((covariance.diagonal().array() < 0.0).any()) return fail("covariance has a negative variance");
  return covariance;
}

/// The error of a part, with the name of the plane and the part in front.
tl::unexpected<Error> fail_at(const v1::Plane& message, std::string_view part, const Error& error) {
  return fail("plane " + std::to_string(message.id()) + ": " + std::string(part) + error.message);
}

Expected<PlaneRecord> record_of(const v1::Plane& message) {
  if (message.id() == kNoPlane || message.id() >= kNumberLimit) return fail("id is 0 or not below 2^53");
  if (!is_unit(vector_of(message.normal()))) return fail("normal is not a unit vector");
  auto plane = Plane::from_coefficients(vector_of(message.normal()), message.d_m());
  if (!plane) return tl::make_unexpected(plane.error());
  auto covariance = covariance_of(message);
  if (!covariance) return tl::make_unexpected(covariance.error());
  PlaneRecord record;
  record.id = message.id();
  record.plane = *plane;
  record.covariance = *covariance;
  record.centroid_m = vector_of(message.centroid_m());
  record.cell_count = message.cell_count();
  record.point_count = message.point_count();
  record.first_seen_utime = message.first_seen_utime();
  record.last_seen_utime = message.last_seen_utime();
  record.quality = message.quality();
  record.revision = message.revision();
  record.merged.assign(message.merged().begin(), message.merged().end());
  if (!record.centroid_m.allFinite()) return fail("centroid_m is not finite");
  if (!(record.quality >= 0.0 && record.quality <= 1.0)) return fail("quality is not within 0 to 1");
  return record;
}

}  // namespace

Expected<PlaneClass> class_of(v1::PlaneClass message) {
  const auto* known = std::find(kClasses.begin(), kClasses.end(), message);
  if (known == kClasses.end()) return fail("plane_class is not known");
  return static_cast<PlaneClass>(known - kClasses.begin());
}

v1::Plane to_proto(const PlaneRecord& record, PlaneClass plane_class, const Outline& outline) {
  v1::Plane message;
  message.set_id(record.id);
  set(*message.mutable_normal(), record.plane.normal());
  message.set_d_m(record.plane.d());
  set_covariance(message, record.covariance);
  set(*message.mutable_centroid_m(), record.centroid_m);
  message.set_cell_count(record.cell_count);
  message.set_point_count(record.point_count);
  message.set_first_seen_utime(record.first_seen_utime);
  message.set_last_seen_utime(record.last_seen_utime);
  message.set_plane_class(kClasses.at(static_cast<std::size_t>(plane_class)));
  message.set_quality(record.quality);
  message.set_revision(record.revision);
  for (const PlaneId id : record.merged) message.add_merged(id);
  set_outline(*message.mutable_outline(), outline);
  return message;
}

v1::Plane to_proto(const ShapedPlane& plane) {
  return to_proto(plane.record, plane.plane_class, plane.outline);
}

v1::Snapshot to_proto(const ShapedMap& map) {
  v1::Snapshot message;
  message.set_frame(map.frame);
  message.set_epoch(map.epoch);
  message.set_revision(map.revision);
  message.set_utime(map.utime);
  message.set_cell_size_m(map.cell_size_m);
  for (const ShapedPlane& plane : map.planes) *message.add_planes() = to_proto(plane);
  return message;
}

Expected<ShapedPlane> from_proto(const v1::Plane& message) {
  auto record = record_of(message);
  if (!record) return fail_at(message, "", record.error());
  ShapedPlane plane;
  plane.record = std::move(*record);
  const auto plane_class = class_of(message.plane_class());
  if (!plane_class) return fail_at(message, "", plane_class.error());
  plane.plane_class = *plane_class;
  auto outline = outline_of_message(message.outline(), plane.record.plane.normal());
  if (!outline) return fail_at(message, "outline: ", outline.error());
  plane.outline = std::move(*outline);
  return plane;
}

Expected<ShapedMap> from_proto(const v1::Snapshot& message) {
  ShapedMap map;
  map.frame = message.frame();
  map.epoch = message.epoch();
  map.revision = message.revision();
  map.utime = message.utime();
  map.cell_size_m = message.cell_size_m();
  if (map.epoch >= kNumberLimit || map.revision >= kNumberLimit) return fail("epoch or revision is not below 2^53");
  if (!std::isfinite(map.cell_size_m) || map.cell_size_m <= 0.0) return fail("cell_size_m is not a number > 0");
  PlaneId last_id = kNoPlane;
  for (const v1::Plane& plane_message : message.planes()) {
    auto plane = from_proto(plane_message);
    if (!plane) return tl::make_unexpected(plane.error());
    if (plane->record.id <= last_id) return fail("planes are not in the order of their ids");
    last_id = plane->record.id;
    map.planes.push_back(std::move(*plane));
  }
  return map;
}

}  // namespace planemap::service

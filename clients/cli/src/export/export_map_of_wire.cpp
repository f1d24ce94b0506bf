#include "export/export_map_of_wire.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace planemap::cli {
namespace {

constexpr std::array kClasses = {PlaneClass::kFloor, PlaneClass::kCeiling, PlaneClass::kWall, PlaneClass::kTable,
                                 PlaneClass::kSlope};

PlaneClass class_named(const std::string& name) {
  const auto found = std::find_if(kClasses.begin(), kClasses.end(), [&](PlaneClass c) { return name_of(c) == name; });
  return found == kClasses.end() ? PlaneClass::kOther : *found;
}

/// Down, as the level surfaces say; empty where there are none.
std::optional<Eigen::Vector3d> gravity_of(const std::vector<ExportPlane>& planes) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const ExportPlane& plane : planes) {
    const Eigen::Vector3d weighted = plane.outline.area_m2 * plane.record.plane.normal();
    if (plane.plane_class == PlaneClass::kFloor || plane.plane_class == PlaneClass::kTable) up += weighted;
    if (plane.plane_class == PlaneClass::kCeiling) up -= weighted;
  }
  if (up.norm() < 1e-9) return std::nullopt;
  return Eigen::Vector3d(-up.normalized());
}

Eigen::Vector3d vector_of(const client::Vector3& v) {
  return {v[0], v[1], v[2]};
}

Ring ring_of(const client::Ring& wire) {
  Ring ring;
  ring.reserve(wire.size());
  for (const auto& uv_m : wire) ring.emplace_back(uv_m[0], uv_m[1]);
  return ring;
}

Outline outline_of_wire(const client::Plane& wire) {
  Outline outline;
  outline.basis = {vector_of(wire.origin_m), vector_of(wire.axis_u), vector_of(wire.axis_v)};
  outline.area_m2 = wire.area_m2;
  for (const client::Polygon& polygon : wire.polygons) {
    Polygon& copy = outline.polygons.emplace_back();
    copy.outer = ring_of(polygon.outer);
    for (const client::Ring& hole : polygon.holes) copy.holes.push_back(ring_of(hole));
  }
  return outline;
}

Expected<ExportPlane> plane_of_wire(const client::Plane& wire) {
  const auto plane = Plane::from_coefficients(vector_of(wire.normal), wire.d);
  if (!plane) return fail("plane " + std::to_string(wire.id) + " of the answer: " + plane.error().message);
  ExportPlane result;
  PlaneRecord& record = result.record;
  record.id = static_cast<PlaneId>(wire.id);
  record.plane = *plane;
  record.covariance = Eigen::Map<const Eigen::Matrix4d>(wire.covariance.data());  // symmetric: either order of storage
  record.centroid_m = vector_of(wire.centroid_m);
  record.cell_count = static_cast<std::uint32_t>(wire.cell_count);
  record.point_count = static_cast<std::uint64_t>(wire.point_count);
  record.first_seen_utime = wire.first_seen_utime;
  record.last_seen_utime = wire.last_seen_utime;
  record.quality = wire.quality;
  record.revision = static_cast<std::uint64_t>(wire.revision);
  result.outline = outline_of_wire(wire);
  result.plane_class = class_named(wire.plane_class);
  return result;
}

CellView cell_of_wire(const client::Cell& wire) {
  CellView cell;
  cell.centre_m = vector_of(wire.centre_m);
  cell.sigma_m = vector_of(wire.sigma_m);
  const Eigen::Vector3d normal = vector_of(wire.normal);
  if (!normal.isZero()) cell.normal = normal;
  cell.deviation_rad = wire.deviation_rad;
  cell.count = static_cast<std::uint64_t>(wire.count);
  cell.plane_id = static_cast<PlaneId>(wire.plane_id);
  return cell;
}

}  // namespace

Expected<ExportMap> export_map_of(const client::Map& wire) {
  ExportMap map;
  map.frame = wire.frame;
  map.epoch = static_cast<std::uint64_t>(wire.epoch);
  map.revision = static_cast<std::uint64_t>(wire.revision);
  for (const client::Plane& wire_plane : wire.planes) {
    auto plane = plane_of_wire(wire_plane);
    if (!plane) return tl::make_unexpected(plane.error());
    map.planes.push_back(std::move(*plane));
  }
  map.gravity = gravity_of(map.planes);
  set_coplanar_links(map.planes);
  map.cells.reserve(wire.cells.size());
  std::transform(wire.cells.begin(), wire.cells.end(), std::back_inserter(map.cells), cell_of_wire);
  map.cell_count = map.cells.size();
  return map;
}

}  // namespace planemap::cli

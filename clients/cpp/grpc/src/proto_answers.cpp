#include "proto_answers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace planemap::client {
namespace {

constexpr std::uint64_t kMostNumber = (std::uint64_t{1} << 53) - 1;  // of ids, epochs, revisions and counts

bool read_vector(const v1::Vector3& message, Vector3& v) {
  v = {message.x(), message.y(), message.z()};
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

bool read_number(std::uint64_t message, std::int64_t& number) {
  number = static_cast<std::int64_t>(message);
  return message <= kMostNumber;
}

bool read_id(std::uint64_t message, std::int64_t& id) {
  return read_number(message, id) && id != 0;
}

template <class Messages>
bool read_ids(const Messages& messages, std::vector<std::int64_t>& ids) {
  bool sound = true;
  for (const std::uint64_t message : messages) sound &= read_id(message, ids.emplace_back());
  return sound;
}

bool read_finite(double message, double& number) {
  number = message;
  return std::isfinite(number);
}

bool read_ring(const v1::Ring& message, Ring& ring) {
  const auto& uv_m = message.uv_m();
  if (uv_m.size() % 2 != 0 || uv_m.size() < 6) return false;
  ring.resize(static_cast<std::size_t>(uv_m.size()) / 2);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    ring[i] = {uv_m[static_cast<int>(2 * i)], uv_m[static_cast<int>(2 * i + 1)]};
  }
  return std::all_of(uv_m.begin(), uv_m.end(), [](float value) { return std::isfinite(value); });
}

bool read_polygon(const v1::Polygon& message, Polygon& polygon) {
  bool sound = read_ring(message.outer(), polygon.outer);
  polygon.holes.reserve(static_cast<std::size_t>(message.holes_size()));
  for (const v1::Ring& hole : message.holes()) sound &= read_ring(hole, polygon.holes.emplace_back());
  return sound;
}

template <class Messages>
bool read_polygons(const Messages& messages, std::vector<Polygon>& polygons) {
  bool sound = true;
  polygons.reserve(static_cast<std::size_t>(messages.size()));
  for (const v1::Polygon& message : messages) sound &= read_polygon(message, polygons.emplace_back());
  return sound;
}

bool read_covariance(const v1::Plane& message, std::array<double, 16>& full) {
  if (message.covariance_size() != 10) return false;
  int next = 0;
  bool sound = true;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = row; column < 4; ++column) {
      sound &= read_finite(message.covariance(next++), full[4 * row + column]);
      full[4 * column + row] = full[4 * row + column];
    }
  }
  return sound;
}

bool read_class(v1::PlaneClass message, std::string& name) {
  static const std::array<const char*, 6> kNames = {"other", "floor", "ceiling", "wall", "table", "slope"};
  const auto number = static_cast<std::size_t>(message);
  if (message < 0 || number >= kNames.size()) return false;
  name = kNames[number];
  return true;
}

bool read_outline(const v1::Outline& message, Plane& plane) {
  return read_vector(message.origin_m(), plane.origin_m) && read_vector(message.axis_u(), plane.axis_u) &&
         read_vector(message.axis_v(), plane.axis_v) && read_polygons(message.polygons(), plane.polygons) &&
         read_finite(message.area_m2(), plane.area_m2);
}

bool read_hit(const v1::PlaneHit& message, PlaneHit& hit) {
  hit.from_behind = message.from_behind();
  return read_id(message.plane_id(), hit.plane_id) && read_finite(message.range_m(), hit.range_m) &&
         read_finite(message.sigma_m(), hit.sigma_m) && read_finite(message.incidence_rad(), hit.incidence_rad) &&
         read_vector(message.point_m(), hit.point_m);
}

bool read_hit(const v1::CellHit& message, CellHit& hit) {
  if (message.has_incidence_rad()) hit.incidence_rad = message.incidence_rad();
  return read(message.cell(), hit.cell) && read_finite(message.entry_m(), hit.entry_m) &&
         read_finite(message.range_m(), hit.range_m) && read_finite(message.sigma_m(), hit.sigma_m) &&
         std::isfinite(hit.incidence_rad.value_or(0.0));
}

PlaneFate fate_of(v1::PlaneFate message) {
  switch (message) {
    case v1::PLANE_FATE_LIVES:
      return PlaneFate::kLives;
    case v1::PLANE_FATE_MERGED:
      return PlaneFate::kMerged;
    case v1::PLANE_FATE_GONE:
      return PlaneFate::kGone;
    default:
      return PlaneFate::kUnknown;
  }
}

double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

void move(std::vector<Polygon>& polygons, double x, double y) {
  const auto move_ring = [&](Ring& ring) {
    for (auto& [u, v] : ring) {
      u += x;
      v += y;
    }
  };
  for (Polygon& polygon : polygons) {
    move_ring(polygon.outer);
    std::for_each(polygon.holes.begin(), polygon.holes.end(), move_ring);
  }
}

}  // namespace

bool read(const v1::MapVersion& message, MapVersion& version) {
  return read_id(message.epoch(), version.epoch) && read_number(message.revision(), version.revision);
}

bool read(const v1::Plane& message, Plane& plane) {
  plane.cell_count = message.cell_count();
  plane.first_seen_utime = message.first_seen_utime();
  plane.last_seen_utime = message.last_seen_utime();
  return read_id(message.id(), plane.id) && read_vector(message.normal(), plane.normal) &&
         read_finite(message.d_m(), plane.d) && read_covariance(message, plane.covariance) &&
         read_vector(message.centroid_m(), plane.centroid_m) && read_number(message.point_count(), plane.point_count) &&
         read_class(message.plane_class(), plane.plane_class) && read_finite(message.quality(), plane.quality) &&
         read_number(message.revision(), plane.revision) && read_outline(message.outline(), plane);
}

bool read(const v1::Cell& message, Cell& cell) {
  cell.deviation_rad = message.deviation_rad();  // infinite where nothing is known of the normal
  return read_vector(message.centre_m(), cell.centre_m) && read_vector(message.sigma_m(), cell.sigma_m) &&
         read_vector(message.normal(), cell.normal) && read_number(message.count(), cell.count) &&
         read_number(message.plane_id(), cell.plane_id);
}

bool read(const v1::RemovedPlane& message, RemovedPlane& removed) {
  return read_id(message.id(), removed.id) && read_number(message.merged_into(), removed.merged_into);
}

bool read(const v1::NearPlane& message, NearPlane& plane) {
  plane.mahalanobis = message.mahalanobis();  // infinite of what is known exactly
  plane.foot_inside = message.foot_inside();
  return read_id(message.plane_id(), plane.plane_id) &&
         read_finite(message.surface_distance_m(), plane.surface_distance_m) &&
         read_vector(message.surface_point_m(), plane.surface_point_m) &&
         read_finite(message.signed_distance_m(), plane.signed_distance_m) &&
         read_finite(message.sigma_m(), plane.sigma_m) && !std::isnan(plane.mahalanobis) &&
         read_vector(message.foot_m(), plane.foot_m);
}

bool read(const v1::RayHits& message, RayHits& hits) {
  return (!message.has_plane() || read_hit(message.plane(), hits.plane.emplace())) &&
         (!message.has_cell() || read_hit(message.cell(), hits.cell.emplace()));
}

bool read(const v1::RegionPlane& message, RegionPlane& plane) {
  plane.whole = message.whole();
  return read(message.plane(), plane.plane) && read_polygons(message.polygons(), plane.clipped) &&
         read_finite(message.area_m2(), plane.clipped_area_m2);
}

bool read(const v1::GetPlaneResponse& message, PlaneAnswer& answer) {
  answer.fate = fate_of(message.fate());
  if (message.has_removed_revision() && !read_number(message.removed_revision(), answer.removed_revision.emplace())) {
    return false;
  }
  const bool is_there = answer.fate == PlaneFate::kLives || answer.fate == PlaneFate::kMerged;
  if (answer.fate == PlaneFate::kUnknown || is_there != message.has_plane()) return false;
  return read(message.map(), answer.version) && read_ids(message.lineage(), answer.lineage) &&
         (!is_there || read(message.plane(), answer.plane.emplace())) &&
         read_finite(message.normal_deviation_rad(), answer.normal_deviation_rad) &&
         read_ids(message.coplanar(), answer.coplanar) && read_ids(message.plane().merged(), answer.merged);
}

bool read(const v1::GetFloorPlanResponse& message, FloorplanAnswer& plan) {
  Vector3 origin_m{};
  const bool sound = read(message.map(), plan.version) && read_vector(message.origin_m(), origin_m) &&
                     read_vector(message.axis_x(), plan.axis_x) && read_vector(message.axis_y(), plan.axis_y) &&
                     read_polygons(message.walls(), plan.walls) && read_polygons(message.floor(), plan.floor) &&
                     read_polygons(message.free_floor(), plan.free_floor) &&
                     read_finite(message.free_area_m2(), plan.free_area_m2);
  plan.up = cross(plan.axis_x, plan.axis_y);
  plan.floor_height_m = dot(origin_m, plan.up);
  // Corners count from origin_m, so that they fit into floats; here they are p . axis.
  for (auto* polygons : {&plan.walls, &plan.floor, &plan.free_floor}) {
    move(*polygons, dot(origin_m, plan.axis_x), dot(origin_m, plan.axis_y));
  }
  return sound;
}

bool read(const v1::GetStatusResponse& message, Status& status) {
  status.utime = message.utime();
  status.version = message.version();
  status.scan_rate_hz = message.scan_rate_hz();
  status.scan_ms_p50 = message.scan_ms_p50();
  status.scan_ms_max = message.scan_ms_max();
  status.last_scan_utime = message.map().utime();
  status.idle_reason = message.idle_reason();
  status.degraded = message.degraded();
  status.counters.insert(message.counters().begin(), message.counters().end());
  MapVersion version;
  const bool sound = read(message.map(), version) && read_number(message.plane_count(), status.plane_count) &&
                     read_number(message.cell_count(), status.cell_count) &&
                     read_number(message.block_count(), status.block_count);
  status.epoch = version.epoch;
  status.revision = version.revision;
  return sound;
}

}  // namespace planemap::client

#include <nlohmann/json.hpp>

#include "export/formats.hpp"

namespace planemap {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json json_of(const Ring& ring, const PlaneBasis& basis) {
  Json points = Json::array();
  for (const Eigen::Vector2d& uv_m : ring) points.push_back(json_of(basis.to_world(uv_m)));
  return points;
}

Json json_of(const Outline& outline) {
  Json polygons = Json::array();
  for (const Polygon& polygon : outline.polygons) {
    Json holes = Json::array();
    for (const Ring& hole : polygon.holes) holes.push_back(json_of(hole, outline.basis));
    polygons.push_back({{"outer", json_of(polygon.outer, outline.basis)}, {"holes", std::move(holes)}});
  }
  return polygons;
}

Json json_of(const ExportPlane& plane) {
  const PlaneRecord& record = plane.record;
  Json covariance = Json::array();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) covariance.push_back(record.covariance(row, column));
  }
  return {{"id", record.id},
          {"normal", json_of(record.plane.normal())},
          {"d", record.plane.d()},
          {"covariance", std::move(covariance)},
          {"centroid", json_of(record.centroid_m)},
          {"area", plane.outline.area_m2},
          {"polygons", json_of(plane.outline)},
          {"cellCount", record.cell_count},
          {"pointCount", record.point_count},
          {"class", name_of(plane.plane_class)},
          {"quality", record.quality},
          {"firstSeenUtime", record.first_seen_utime},
          {"lastSeenUtime", record.last_seen_utime},
          {"coplanar", plane.coplanar}};
}

}  // namespace

std::string plane_json(const ExportPlane& plane) {
  return json_of(plane).dump();
}

void write_planes_json(const ExportMap& map, std::ostream& out) {
  // A plane a line: a diff of two maps then shows which planes differ.
  out << R"({"frame": )" << Json(map.frame).dump() << R"(, "epoch": )" << map.epoch << R"(, "revision": )"
      << map.revision << R"(, "planes": [)";
  const char* separator = "\n";
  for (const ExportPlane& plane : map.planes) {
    out << separator << plane_json(plane);
    separator = ",\n";
  }
  out << "\n]}\n";
}

}  // namespace planemap

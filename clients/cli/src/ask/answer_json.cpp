#include "ask/answer_json.hpp"

#include <cmath>
#include <functional>
#include <utility>

namespace planemap::cli {
namespace {

using PointJson = std::function<Json(const std::array<double, 2>&)>;

Json json_of_ring(const client::Ring& ring, const PointJson& point_json) {
  Json points = Json::array();
  for (const auto& uv_m : ring) points.push_back(point_json(uv_m));
  return points;
}

Json json_of_polygons(const std::vector<client::Polygon>& polygons, const PointJson& point_json) {
  Json list = Json::array();
  for (const client::Polygon& polygon : polygons) {
    Json holes = Json::array();
    for (const client::Ring& hole : polygon.holes) holes.push_back(json_of_ring(hole, point_json));
    list.push_back({{"outer", json_of_ring(polygon.outer, point_json)}, {"holes", std::move(holes)}});
  }
  return list;
}

}  // namespace

Json json_of(const client::Vector3& vector) {
  return Json::array({vector[0], vector[1], vector[2]});
}

Json json_of(const std::vector<client::Polygon>& polygons) {
  return json_of_polygons(polygons, [](const std::array<double, 2>& uv_m) { return Json::array({uv_m[0], uv_m[1]}); });
}

Json json_of(const std::vector<client::Polygon>& polygons, const client::Plane& basis) {
  return json_of_polygons(polygons, [&](const std::array<double, 2>& uv_m) {
    client::Vector3 p_m{};
    for (std::size_t i = 0; i < 3; ++i) {
      p_m[i] = basis.origin_m[i] + uv_m[0] * basis.axis_u[i] + uv_m[1] * basis.axis_v[i];
    }
    return json_of(p_m);
  });
}

Json json_of(const client::Cell& cell) {
  return {{"centre", json_of(cell.centre_m)},
          {"sigma", json_of(cell.sigma_m)},
          {"normal", cell.normal == client::Vector3{} ? Json() : json_of(cell.normal)},
          {"normalDeviation", cell.deviation_rad},
          {"count", cell.count},
          {"plane", cell.plane_id}};
}

Json json_of(const client::Plane& plane) {
  return {{"id", plane.id},
          {"normal", json_of(plane.normal)},
          {"d", plane.d},
          {"covariance", plane.covariance},
          {"centroid", json_of(plane.centroid_m)},
          {"area", plane.area_m2},
          {"polygons", json_of(plane.polygons, plane)},
          {"cellCount", plane.cell_count},
          {"pointCount", plane.point_count},
          {"class", plane.plane_class},
          {"quality", plane.quality},
          {"firstSeenUtime", plane.first_seen_utime},
          {"lastSeenUtime", plane.last_seen_utime}};
}

Json json_of(const client::MapVersion& version) {
  return {{"epoch", version.epoch}, {"revision", version.revision}};
}

Json json_of_number(double number) {
  return std::isfinite(number) ? Json(number) : Json();
}

}  // namespace planemap::cli

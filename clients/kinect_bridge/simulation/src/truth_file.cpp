#include <fstream>
#include <nlohmann/json.hpp>
#include <planemap/coplanar.hpp>
#include <planemap/simulation/truth_file.hpp>
#include <system_error>

namespace planemap::simulation {
namespace {

using Json = nlohmann::ordered_json;  // in the order of the schema

Json to_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Eigen::Vector3d centroid_of(const Surface& surface) {
  const double total_m2 = area_m2(surface);
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  for (const ConvexPiece& piece_m : surface.pieces_m) {
    for (std::size_t i = 1; i + 1 < piece_m.size(); ++i) {
      const ConvexPiece triangle_m = {piece_m[0], piece_m[i], piece_m[i + 1]};
      centroid_m += area_m2(triangle_m) / total_m2 * (triangle_m[0] + triangle_m[1] + triangle_m[2]) / 3.0;
    }
  }
  return centroid_m;
}

CoplanarLinks links_of(std::span<const Surface> surfaces) {
  std::vector<PlaneRecord> records;
  std::vector<double> areas_m2;
  for (const Surface& surface : surfaces) {
    if (surface.facet) continue;
    areas_m2.push_back(area_m2(surface));
    PlaneRecord& record = records.emplace_back();
    record.id = surface.id;
    record.plane = surface.plane;
    record.centroid_m = centroid_of(surface);
  }
  std::vector<SizedPlane> planes;
  for (std::size_t i = 0; i < records.size(); ++i) planes.push_back({&records[i], areas_m2[i]});
  return coplanar_links(planes);
}

Json to_json(const Surface& surface, const CoplanarLinks& links) {
  Json polygons = Json::array();
  for (const ConvexPiece& piece_m : surface.pieces_m) {
    Json ring = Json::array();
    for (const Eigen::Vector3d& corner_m : piece_m) ring.push_back(to_json(corner_m));
    polygons.push_back({{"outer", std::move(ring)}, {"holes", Json::array()}});
  }
  const auto linked = links.find(surface.id);
  return {{"id", surface.id},
          {"name", surface.name},
          {"normal", to_json(surface.plane.normal())},
          {"d", surface.plane.d()},
          {"covariance", std::vector<double>(16, 0.0)},
          {"centroid", to_json(centroid_of(surface))},
          {"area", area_m2(surface)},
          {"polygons", std::move(polygons)},
          {"cellCount", 0},
          {"pointCount", 0},
          {"class", name_of(surface.plane_class)},
          {"quality", 1.0},
          {"firstSeenUtime", 0},
          {"lastSeenUtime", 0},
          {"coplanar", linked == links.end() ? std::vector<PlaneId>() : linked->second}};
}

}  // namespace

std::string truth_json(std::span<const Surface> surfaces) {
  // One plane a line: to be read by people too.
  std::string text = R"({"frame":"world","epoch":0,"revision":0,"planes":[)";
  const char* separator = "\n";
  const CoplanarLinks links = links_of(surfaces);
  for (const Surface& surface : surfaces) {
    if (surface.facet) continue;
    text += separator + to_json(surface, links).dump();
    separator = ",\n";
  }
  return text + "\n]}\n";
}

Expected<void> write_truth_file(std::span<const Surface> surfaces, const std::filesystem::path& path) {
  std::filesystem::path partial = path;
  partial += ".part";
  std::ofstream file(partial, std::ios::binary | std::ios::trunc);
  file << truth_json(surfaces);
  file.close();
  if (!file) return fail(partial.string() + ": can't be written");
  std::error_code error;
  std::filesystem::rename(partial, path, error);
  if (error) return fail(path.string() + ": can't be written: " + error.message());
  return {};
}

}  // namespace planemap::simulation

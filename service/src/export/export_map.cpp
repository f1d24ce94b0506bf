#include "export/export_map.hpp"

#include <map>
#include <planemap/classify.hpp>
#include <planemap/coplanar.hpp>
#include <utility>

namespace planemap {
namespace {

using CentresByPlane = std::map<PlaneId, std::vector<Eigen::Vector3d>>;

void set_classes(std::vector<ExportPlane>& planes, const std::optional<Eigen::Vector3d>& gravity) {
  std::vector<Surface> surfaces;
  surfaces.reserve(planes.size());
  for (const ExportPlane& plane : planes) {
    surfaces.push_back({plane.record.plane, plane.record.centroid_m, plane.outline.area_m2});
  }
  const std::vector<PlaneClass> classes = classify(surfaces, gravity);
  for (std::size_t i = 0; i < planes.size(); ++i) planes[i].plane_class = classes[i];
}

}  // namespace

void set_coplanar_links(std::vector<ExportPlane>& planes) {
  std::vector<SizedPlane> sized;
  sized.reserve(planes.size());
  for (const ExportPlane& plane : planes) sized.push_back({&plane.record, plane.outline.area_m2});
  CoplanarLinks links = coplanar_links(sized);
  for (ExportPlane& plane : planes) {
    if (const auto linked = links.find(plane.record.id); linked != links.end()) plane.coplanar = linked->second;
  }
}

ExportMap export_map_of(const MapSnapshot& snapshot, const std::string& frame,
                        const std::optional<Eigen::Vector3d>& gravity) {
  ExportMap map;
  map.frame = frame;
  map.epoch = snapshot.epoch();
  map.revision = snapshot.revision();
  if (gravity) map.gravity = gravity->normalized();
  CentresByPlane centres_m;
  snapshot.for_each_cell([&](const CellView& cell) {
    map.cells.push_back(cell);
    if (cell.plane_id != kNoPlane) centres_m[cell.plane_id].push_back(cell.centre_m);
  });
  map.planes.reserve(snapshot.planes().size());
  for (const auto& record : snapshot.planes()) {
    ExportPlane& plane = map.planes.emplace_back();
    plane.record = *record;
    plane.outline = outline_of(record->plane, record->centroid_m, centres_m[record->id], snapshot.cell_size_m());
  }
  set_classes(map.planes, map.gravity);
  map.cell_count = map.cells.size();
  set_coplanar_links(map.planes);
  return map;
}

ExportMap export_map_of(const SnapshotQueries& queries, const std::string& frame,
                        const std::optional<Eigen::Vector3d>& gravity) {
  const MapSnapshot& snapshot = queries.snapshot();
  ExportMap map;
  map.frame = frame;
  map.epoch = snapshot.epoch();
  map.revision = snapshot.revision();
  if (gravity) map.gravity = gravity->normalized();
  map.planes.reserve(queries.planes().size());
  for (const DescribedPlane& plane : queries.planes()) {
    map.planes.push_back({*plane.record, *plane.outline, plane.plane_class, {}});
  }
  snapshot.for_each_cell([&](const CellView&) { ++map.cell_count; });
  set_coplanar_links(map.planes);
  return map;
}

}  // namespace planemap

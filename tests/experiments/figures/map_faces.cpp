#include "figures/map_faces.hpp"

#include <algorithm>
#include <numeric>

namespace planemap::experiments {

MapFaces faces_of(const MapSnapshot& map, double least_area_m2) {
  std::map<PlaneId, std::vector<Eigen::Vector3d>> cells;
  map.for_each_cell([&](const CellView& cell) {
    if (cell.plane_id != kNoPlane) cells[cell.plane_id].push_back(cell.centre_m);
  });
  MapFaces all;
  for (const auto& [id, centres_m] : cells) {
    const PlaneRecord& record = *map.find(id);
    const Outline outline = outline_of(record.plane, record.centroid_m, centres_m, map.cell_size_m());
    if (outline.area_m2 < least_area_m2) continue;
    all.faces.push_back({record.plane, outline, {}});
    all.ids.push_back(id);
  }
  std::vector<std::size_t> order(all.ids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return all.faces[a].outline.area_m2 > all.faces[b].outline.area_m2;
  });
  MapFaces sorted;
  for (const std::size_t i : order) {
    sorted.faces.push_back(all.faces[i]);
    sorted.faces.back().colour = colour_of_rank(sorted.ids.size());
    sorted.ids.push_back(all.ids[i]);
  }
  return sorted;
}

std::vector<PictureFace> faces_of(const std::vector<RansacPlane>& planes, const std::vector<Eigen::Vector3f>& cloud_m,
                                  const std::vector<Eigen::Vector3d>& sensors_m, double cell_size_m) {
  std::vector<PictureFace> faces;
  for (const RansacPlane& found : planes) {
    std::vector<Eigen::Vector3d> points_m;
    Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
    for (const std::uint32_t i : found.inliers) {
      points_m.emplace_back(cloud_m[i].cast<double>());
      centroid_m += points_m.back() / static_cast<double>(found.inliers.size());
    }
    // RANSAC does not know sides: the one that most of the scans were taken from.
    const auto in_front = std::count_if(sensors_m.begin(), sensors_m.end(),
                                        [&](const auto& p) { return found.plane.signed_distance_m(p) > 0.0; });
    const double side = 2 * in_front >= static_cast<long>(sensors_m.size()) ? 1.0 : -1.0;
    const Plane plane = Plane::through(centroid_m, side * found.plane.normal());
    faces.push_back({plane, outline_of(plane, centroid_m, points_m, cell_size_m), colour_of_rank(faces.size())});
  }
  return faces;
}

}  // namespace planemap::experiments

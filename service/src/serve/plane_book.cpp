#include "serve/plane_book.hpp"

#include <planemap/classify.hpp>
#include <utility>

namespace planemap::service {

PlaneBook::PlaneBook(const MapConfig& config) {
  if (config.gravity.size() == 3) gravity_ = Eigen::Map<const Eigen::Vector3d>(config.gravity.data());
}

const std::vector<DescribedPlane>& PlaneBook::describe(const std::shared_ptr<const MapSnapshot>& snapshot) {
  if (snapshot != snapshot_) {
    refresh_outlines(*snapshot);
    refresh_classes();
    snapshot_ = snapshot;
  }
  return planes_;
}

void PlaneBook::refresh_outlines(const MapSnapshot& snapshot) {
  std::unordered_map<const PlaneRecord*, std::shared_ptr<const Outline>> known;
  for (const auto& plane : planes_) known.emplace(plane.record.get(), plane.outline);
  std::vector<DescribedPlane> planes;
  std::unordered_map<PlaneId, std::vector<Eigen::Vector3d>> cells_of_changed;
  for (const auto& record : snapshot.planes()) {
    // The old planes hold their records, so an address says which record it is.
    const auto found = known.find(record.get());
    if (found == known.end()) cells_of_changed.emplace(record->id, std::vector<Eigen::Vector3d>{});
    planes.push_back({record, found == known.end() ? nullptr : found->second, PlaneClass::kOther});
  }
  if (!cells_of_changed.empty()) {
    snapshot.for_each_cell([&](const CellView& cell) {
      const auto entry = cells_of_changed.find(cell.plane_id);
      if (entry != cells_of_changed.end()) entry->second.push_back(cell.centre_m);
    });
  }
  for (auto& plane : planes) {
    if (plane.outline) continue;
    const PlaneRecord& record = *plane.record;
    plane.outline = std::make_shared<const Outline>(
        outline_of(record.plane, record.centroid_m, cells_of_changed.at(record.id), snapshot.cell_size_m()));
  }
  planes_ = std::move(planes);
}

void PlaneBook::refresh_classes() {
  std::vector<Surface> surfaces;
  surfaces.reserve(planes_.size());
  for (const auto& plane : planes_) {
    surfaces.push_back(Surface{plane.record->plane, plane.record->centroid_m, plane.outline->area_m2});
  }
  const auto classes = classify(surfaces, gravity_);
  for (std::size_t i = 0; i < planes_.size(); ++i) planes_[i].plane_class = classes[i];
}

}  // namespace planemap::service

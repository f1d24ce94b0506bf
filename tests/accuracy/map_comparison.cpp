#include "map_comparison.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <planemap/moments.hpp>
#include <utility>

#include "scoring.hpp"

namespace planemap::accuracy {

namespace {

using Place = std::array<int, 3>;

Place place_of(const CellView& cell) {
  return {cell.index.x(), cell.index.y(), cell.index.z()};
}

/// The planes at each place: two cells may share one.
std::map<Place, std::vector<PlaneId>> planes_by_place(const MapSnapshot& map) {
  std::map<Place, std::vector<PlaneId>> planes;
  map.for_each_cell([&](const CellView& cell) {
    if (cell.plane_id != kNoPlane) planes[place_of(cell)].push_back(cell.plane_id);
  });
  return planes;
}

struct Extent {
  std::size_t cells = 0;
  Moments points;  ///< about the plane's centroid

  double width_m() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(points.covariance(), Eigen::EigenvaluesOnly);
    return std::sqrt(12.0 * std::max(solver.eigenvalues()(1), 0.0));
  }
};

std::map<PlaneId, Extent> extents(const MapSnapshot& map) {
  std::map<PlaneId, Extent> extents;
  map.for_each_cell([&](const CellView& cell) {
    if (cell.plane_id == kNoPlane) return;
    Extent& extent = extents[cell.plane_id];
    ++extent.cells;
    const Eigen::Vector3d p_m = cell.centre_m - map.find(cell.plane_id)->centroid_m;
    extent.points.add(Moments{1.0, p_m, Symmetric3::outer(p_m)}, static_cast<double>(cell.count), {0.0, 0.0, 0.0});
  });
  return extents;
}

/// Standard error of the normal in the direction in which it is known worst.
double tilt_sigma_deg(const PlaneRecord& plane) {
  const Eigen::Matrix3d of_normal = plane.covariance.topLeftCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(of_normal, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues()(2), 0.0)) * 180.0 / std::numbers::pi;
}

/// How much of the seen surfaces is in planes of one map, of another, and in a plane of one and a plane of the other.
class SurfaceOverlaps {
 public:
  SurfaceOverlaps(const MapSnapshot& map, const MapSnapshot& other, const SeenSurfaces& seen) {
    const std::vector<SeenSurfaces::Patch> patches = seen.patches();
    const std::vector<PlaneId> a = planes_of_patches(map, seen);
    const std::vector<PlaneId> b = planes_of_patches(other, seen);
    for (std::size_t i = 0; i < patches.size(); ++i) {
      map_m2_[a[i]] += patches[i].area_m2;
      other_m2_[b[i]] += patches[i].area_m2;
      shared_m2_[{a[i], b[i]}] += patches[i].area_m2;
    }
  }
  double of(PlaneId plane, PlaneId partner) const {
    const auto shared = shared_m2_.find({plane, partner});
    if (shared == shared_m2_.end()) return 0.0;
    return shared->second / std::max(map_m2_.at(plane), other_m2_.at(partner));
  }

 private:
  std::map<PlaneId, double> map_m2_;
  std::map<PlaneId, double> other_m2_;
  std::map<std::pair<PlaneId, PlaneId>, double> shared_m2_;
};

}  // namespace

double PlanePair::shared_cell_share() const {
  const std::size_t most = std::max(cells, partner_cells);
  return most > 0 ? static_cast<double>(shared_cells) / static_cast<double>(most) : 0.0;
}

std::vector<PlanePair> pair_planes(const MapSnapshot& map, const MapSnapshot& other, const SeenSurfaces& seen,
                                   std::size_t least_cells) {
  const SurfaceOverlaps overlaps(map, other, seen);
  const auto others = planes_by_place(other);
  std::map<PlaneId, std::map<PlaneId, std::size_t>> shared;
  map.for_each_cell([&](const CellView& cell) {
    const auto found = others.find(place_of(cell));
    if (cell.plane_id == kNoPlane || found == others.end()) return;
    for (const PlaneId id : found->second) ++shared[cell.plane_id][id];
  });
  const auto extents_of_other = extents(other);
  std::vector<PlanePair> pairs;
  for (const auto& [id, extent] : extents(map)) {
    if (extent.cells < least_cells) continue;
    PlanePair pair;
    pair.plane = id;
    pair.cells = extent.cells;
    pair.width_m = extent.width_m();
    pair.tilt_sigma_deg = tilt_sigma_deg(*map.find(id));
    for (const auto& [partner, count] : shared[id]) {
      if (count <= pair.shared_cells) continue;
      pair.partner = partner;
      pair.shared_cells = count;
    }
    if (pair.partner != kNoPlane) {
      pair.partner_cells = extents_of_other.at(pair.partner).cells;
      pair.shared_surface = overlaps.of(id, pair.partner);
      const PlaneRecord& a = *map.find(id);
      const PlaneRecord& b = *other.find(pair.partner);
      const Eigen::Vector3d& n = a.plane.normal();
      pair.angle_deg = std::atan2(n.cross(b.plane.normal()).norm(), n.dot(b.plane.normal())) * 180.0 / std::numbers::pi;
      pair.offset_m = std::abs(b.plane.signed_distance_m(a.centroid_m));
    }
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace planemap::accuracy

#include "scoring.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace planemap::accuracy {

namespace {

constexpr double kPatch_m2 = SeenSurfaces::kPitch_m * SeenSurfaces::kPitch_m;

/// Cells, found by place.
class CellFinder {
 public:
  explicit CellFinder(const MapSnapshot& map) : map_(&map), size_m_(map.cell_size_m()) {
    map.for_each_cell([&](const CellView& cell) { cells_[key_of(cell.centre_m)].push_back(cell); });
  }

  /// The plane that a piece of surface belongs to: of those that own a cell at most 1.5 cells away and face the same
  /// way within 45 degrees, the one that passes nearest to it, as a reader of the planes would tell. kNoPlane: there is
  /// none.
  PlaneId plane_at(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const {
    const double reach_m2 = 2.25 * size_m_ * size_m_;
    PlaneId best = kNoPlane;
    double best_m = size_m_;
    for_each_near(p, [&](const CellView& cell) {
      if (cell.plane_id == kNoPlane || cell.plane_id == best || (cell.centre_m - p).squaredNorm() > reach_m2) return;
      const Plane& plane = map_->find(cell.plane_id)->plane;
      const double distance_m = std::abs(plane.signed_distance_m(p));
      if (distance_m >= best_m || plane.normal().dot(normal) < std::numbers::sqrt2 / 2.0) return;
      best_m = distance_m;
      best = cell.plane_id;
    });
    return best;
  }

 private:
  using Key = std::array<int, 3>;
  Key key_of(const Eigen::Vector3d& p) const {
    const Eigen::Array3i i = (p.array() / size_m_).floor().cast<int>();
    return {i.x(), i.y(), i.z()};
  }
  template <class Visit>
  void for_each_near(const Eigen::Vector3d& p, Visit&& visit) const {
    const Key middle = key_of(p);
    for (int z = -2; z <= 2; ++z) {
      for (int y = -2; y <= 2; ++y) {
        for (int x = -2; x <= 2; ++x) {
          const auto found = cells_.find({middle[0] + x, middle[1] + y, middle[2] + z});
          if (found == cells_.end()) continue;
          for (const CellView& cell : found->second) visit(cell);
        }
      }
    }
  }

  const MapSnapshot* map_;
  double size_m_;
  std::map<Key, std::vector<CellView>> cells_;
};

/// Squared error of (n, d) in units of its covariance, by the pseudo-inverse of rank 3.
double nees_of(const PlaneRecord& record, const Plane& truth) {
  Eigen::Vector4d error;
  error << record.plane.normal() - truth.normal(), record.plane.d() - truth.d();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(record.covariance);
  double nees = 0.0;
  for (int i = 1; i < 4; ++i) {
    const double along = solver.eigenvectors().col(i).dot(error);
    nees += along * along / solver.eigenvalues()(i);
  }
  return nees;
}

/// Overlap of each surface with each plane, square metres.
struct Table {
  std::vector<double> seen_m2;                        ///< by surface
  std::vector<std::map<PlaneId, double>> overlap_m2;  ///< by surface, then plane
  std::map<PlaneId, double> plane_m2;                 ///< all of a plane: on surfaces, and on none
};

Table tabulate(const MapSnapshot& map, const SeenSurfaces& seen) {
  Table table{std::vector<double>(seen.surfaces().size()), {}, {}};
  table.overlap_m2.resize(seen.surfaces().size());
  const CellFinder cells(map);
  const double size_m = map.cell_size_m();
  std::map<std::array<int, 3>, bool> near_surface;
  for (const SeenSurfaces::Patch& patch : seen.patches()) {
    table.seen_m2[patch.surface] += kPatch_m2;
    const Eigen::Array3i i = (patch.centre_m.array() / size_m).floor().cast<int>();
    near_surface[{i.x(), i.y(), i.z()}] = true;
    const PlaneId plane = cells.plane_at(patch.centre_m, seen.surfaces()[patch.surface].plane.normal());
    if (plane == kNoPlane) continue;
    table.overlap_m2[patch.surface][plane] += kPatch_m2;
    table.plane_m2[plane] += kPatch_m2;
  }
  // Cells that hang in the air weigh against their plane.
  map.for_each_cell([&](const CellView& cell) {
    if (cell.plane_id == kNoPlane) return;
    const Eigen::Array3i i = (cell.centre_m.array() / size_m).floor().cast<int>();
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          if (near_surface.count({i.x() + x, i.y() + y, i.z() + z}) > 0) return;
        }
      }
    }
    table.plane_m2[cell.plane_id] += size_m * size_m;
  });
  return table;
}

Verdict judge(const Table& table, std::size_t surface, const SurfaceScore& best, double overlap) {
  if (best.overlap >= overlap && best.purity >= overlap) return Verdict::kCorrect;
  // Over-segmented: planes that are on this surface cover it together.
  double together_m2 = 0.0;
  for (const auto& [plane, m2] : table.overlap_m2[surface]) {
    if (m2 >= overlap * table.plane_m2.at(plane)) together_m2 += m2;
  }
  if (together_m2 >= overlap * table.seen_m2[surface]) return Verdict::kOverSegmented;
  // Under-segmented: a plane covers this surface, and others too.
  if (best.overlap >= overlap) return Verdict::kUnderSegmented;
  return Verdict::kMissed;
}

}  // namespace

std::size_t Score::count(Verdict verdict) const {
  return static_cast<std::size_t>(
      std::count_if(surfaces.begin(), surfaces.end(), [&](const SurfaceScore& s) { return s.verdict == verdict; }));
}

double Score::seen_m2() const {
  return std::accumulate(surfaces.begin(), surfaces.end(), 0.0, [](double a, const auto& s) { return a + s.seen_m2; });
}

double Score::labelled_m2() const {
  return std::accumulate(surfaces.begin(), surfaces.end(), 0.0,
                         [](double a, const auto& s) { return a + s.labelled_m2; });
}

Score score(const MapSnapshot& map, const SeenSurfaces& seen, double overlap, double least_m2) {
  const Table table = tabulate(map, seen);
  Score result;
  std::map<PlaneId, bool> on_surface;
  for (std::size_t i = 0; i < seen.surfaces().size(); ++i) {
    const simulation::Surface& surface = seen.surfaces()[i];
    SurfaceScore s;
    s.name = surface.name;
    s.seen_m2 = table.seen_m2[i];
    double best_m2 = 0.0;
    for (const auto& [plane, m2] : table.overlap_m2[i]) {
      s.labelled_m2 += m2;
      if (m2 >= 0.5 * table.plane_m2.at(plane)) on_surface[plane] = true;
      if (m2 <= best_m2) continue;
      best_m2 = m2;
      s.plane = plane;
      s.overlap = m2 / s.seen_m2;
      s.purity = m2 / table.plane_m2.at(plane);
    }
    if (s.seen_m2 < least_m2) continue;
    s.verdict = judge(table, i, s, overlap);
    if (s.verdict == Verdict::kCorrect) {
      const PlaneRecord& record = *map.find(s.plane);
      const double cosine = std::clamp(record.plane.normal().dot(surface.plane.normal()), -1.0, 1.0);
      s.normal_error_deg = std::acos(cosine) * 180.0 / std::numbers::pi;
      s.offset_error_m = std::abs(surface.plane.signed_distance_m(record.centroid_m));
      s.nees = nees_of(record, surface.plane);
    }
    result.surfaces.push_back(s);
  }
  for (const auto& [plane, m2] : table.plane_m2) {
    if (m2 >= least_m2 && !on_surface[plane]) result.noise.push_back(plane);
  }
  return result;
}

}  // namespace planemap::accuracy

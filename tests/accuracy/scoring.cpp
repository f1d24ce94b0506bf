#include "scoring.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "joined_surfaces.hpp"

namespace planemap::accuracy {

namespace {

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

/// Also right for tiny angles, where the cosine is 1 to the last digit.
double angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Squared error of (n, d) in units of its covariance times a factor, by the pseudo-inverse of rank 3.
double nees_of(const PlaneRecord& record, const Plane& truth, double covariance_scale) {
  Eigen::Vector4d error;
  error << record.plane.normal() - truth.normal(), record.plane.d() - truth.d();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(covariance_scale * record.covariance);
  double nees = 0.0;
  for (int i = 1; i < 4; ++i) {
    const double along = solver.eigenvectors().col(i).dot(error);
    nees += along * along / solver.eigenvalues()(i);
  }
  return nees;
}

/// Overlap of each surface with each plane, square metres. What counts as part of another surface is in that one.
struct Table {
  std::vector<double> seen_m2;                        ///< by surface
  std::vector<std::map<PlaneId, double>> overlap_m2;  ///< by surface, then plane
  std::map<PlaneId, double> facet_m2;                 ///< of a plane: what lies as a facet on curved surfaces
  std::map<PlaneId, double> plane_m2;                 ///< all of a plane: on surfaces, and on none
};

Table tabulate(const MapSnapshot& map, const SeenSurfaces& seen, const std::vector<std::size_t>& whole) {
  Table table{std::vector<double>(seen.surfaces().size()), {}, {}, {}};
  table.overlap_m2.resize(seen.surfaces().size());
  const CellFinder cells(map);
  const double size_m = map.cell_size_m();
  std::map<std::array<int, 3>, bool> near_surface;
  for (const SeenSurfaces::Patch& patch : seen.patches()) {
    const simulation::Surface& surface = seen.surfaces()[patch.surface];
    const std::size_t counted = whole[patch.surface];
    table.seen_m2[counted] += patch.area_m2;
    const Eigen::Array3i i = (patch.centre_m.array() / size_m).floor().cast<int>();
    near_surface[{i.x(), i.y(), i.z()}] = true;
    const PlaneId plane = cells.plane_at(patch.centre_m, surface.plane.normal());
    if (plane == kNoPlane) continue;
    table.overlap_m2[counted][plane] += patch.area_m2;
    table.plane_m2[plane] += patch.area_m2;
    if (surface.facet && std::abs(map.find(plane)->plane.signed_distance_m(patch.centre_m)) <= kFacetOffset_m) {
      table.facet_m2[plane] += patch.area_m2;
    }
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

/// Errors of the plane of a correct surface.
void measure(const PlaneRecord& record, const Plane& truth, double covariance_scale, SurfaceScore& s) {
  s.normal_error_deg = angle_rad(record.plane.normal(), truth.normal()) * 180.0 / std::numbers::pi;
  s.offset_error_m = std::abs(truth.signed_distance_m(record.centroid_m));
  s.nees = nees_of(record, truth, covariance_scale);
}

OutlineScore outline_score(const MapSnapshot& map, const SeenSurfaces& seen, PlaneId plane, std::size_t surface) {
  const PlaneRecord& record = *map.find(plane);
  const Outline outline = outline_of(record.plane, record.centroid_m, centres_of(map, plane), map.cell_size_m());
  return score_outline(outline, seen, surface);
}

/// @param correct  correct surfaces by their planes
std::vector<CellNormalError> cell_normal_errors(const MapSnapshot& map, const SeenSurfaces& seen,
                                                const std::map<PlaneId, std::size_t>& correct) {
  // A neighbourhood of depth 1 goes a cell and a half from the middle of its cell, and a centre lies half a cell off
  // that.
  const double reach_m = 2.0 * map.cell_size_m();
  std::vector<CellNormalError> errors;
  map.for_each_cell([&](const CellView& cell) {
    const auto found = correct.find(cell.plane_id);
    if (!cell.normal || found == correct.end()) return;
    const Plane& truth = seen.surfaces()[found->second].plane;
    const bool inside = std::abs(truth.signed_distance_m(cell.centre_m)) < map.cell_size_m() &&
                        seen.all_seen_about(found->second, cell.centre_m, reach_m);
    errors.push_back({angle_rad(*cell.normal, truth.normal()), cell.deviation_rad, inside});
  });
  return errors;
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kCorrect:
      return "correct";
    case Verdict::kOverSegmented:
      return "over-segmented";
    case Verdict::kUnderSegmented:
      return "under-segmented";
    case Verdict::kMissed:
      break;
  }
  return "missed";
}

std::vector<PlaneId> planes_of_patches(const MapSnapshot& map, const SeenSurfaces& seen) {
  const CellFinder cells(map);
  std::vector<PlaneId> planes;
  for (const SeenSurfaces::Patch& patch : seen.patches()) {
    planes.push_back(cells.plane_at(patch.centre_m, seen.surfaces()[patch.surface].plane.normal()));
  }
  return planes;
}

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

Score score(const MapSnapshot& map, const SeenSurfaces& seen, const ScoreOptions& options) {
  const std::vector<std::size_t> whole = joined_surfaces(seen.surfaces());
  const Table table = tabulate(map, seen, whole);
  Score result;
  std::map<PlaneId, bool> on_surface;
  std::map<PlaneId, std::size_t> correct;  // surface by plane
  for (std::size_t i = 0; i < seen.surfaces().size(); ++i) {
    const simulation::Surface& surface = seen.surfaces()[i];
    if (surface.facet) continue;
    if (whole[i] != i) {
      if (seen.seen_m2(i) >= options.least_m2) ++result.joined;
      continue;
    }
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
    if (s.seen_m2 < options.least_m2) continue;
    s.verdict = judge(table, i, s, options.overlap);
    if (s.verdict == Verdict::kCorrect) {
      measure(*map.find(s.plane), surface.plane, options.covariance_scale, s);
      // What was seen is known by surface: the outline of a plane that holds parts of two is not scored.
      if (std::count(whole.begin(), whole.end(), i) == 1) s.outline = outline_score(map, seen, s.plane, i);
      correct[s.plane] = i;
    }
    result.surfaces.push_back(s);
  }
  for (const auto& [plane, m2] : table.facet_m2) {
    if (m2 >= options.overlap * table.plane_m2.at(plane)) on_surface[plane] = true;
  }
  for (const auto& [plane, m2] : table.plane_m2) {
    if (m2 >= options.least_m2 && !on_surface[plane]) result.noise.push_back(plane);
  }
  result.cell_normals = cell_normal_errors(map, seen, correct);
  return result;
}

}  // namespace planemap::accuracy

#include "real/plane_comparison.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <planemap/expected_distance.hpp>
#include <planemap/moments.hpp>
#include <planemap/uncertain_grid.hpp>

namespace planemap::experiments {

namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// Dense cells, found by the place of their virtual centres.
class CellFinder {
 public:
  explicit CellFinder(const MapSnapshot& map) : index_(map.cell_size_m()) {
    map.for_each_cell([&](const CellView& cell) { cells_[key_of(index_.index_of(cell.centre_m))].push_back(cell); });
  }

  /// The cell that Eq. 7 gives the point to, of those with their centre at most a cell away along each axis.
  const CellView* cell_of(const Eigen::Vector3d& p_m) const {
    const CellView* best = nullptr;
    double least_m2 = std::numeric_limits<double>::infinity();
    for_each_near(p_m, [&](const CellView& cell) {
      const CentreStatistics centre{1.0, cell.centre_m, cell.sigma_m.cwiseAbs2()};
      const double distance_m2 = expected_squared_distance(p_m, Eigen::Vector3d::Zero(), centre);
      if (distance_m2 >= least_m2) return;
      least_m2 = distance_m2;
      best = &cell;
    });
    return best;
  }

 private:
  using Key = std::array<int, 3>;
  static Key key_of(const CellIndex& i) { return {i.x(), i.y(), i.z()}; }
  template <class Visit>
  void for_each_near(const Eigen::Vector3d& p_m, Visit&& visit) const {
    const CellIndex middle = index_.index_of(p_m);
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const auto found = cells_.find(key_of(middle + CellIndex(x, y, z)));
          if (found == cells_.end()) continue;
          for (const CellView& cell : found->second) visit(cell);
        }
      }
    }
  }

  UncertainGrid index_;  ///< empty; knows which cube a point is in
  std::map<Key, std::vector<CellView>> cells_;
};

double mean_distance_m(const Plane& plane, const RansacPlane& ransac, const std::vector<Eigen::Vector3f>& cloud_m) {
  double sum_m = 0.0;
  for (const std::uint32_t i : ransac.inliers) sum_m += std::abs(plane.signed_distance_m(cloud_m[i].cast<double>()));
  return sum_m / static_cast<double>(ransac.inliers.size());
}

/// Between the distances to a plane that 10 % and 90 % of the points are below.
double thickness_m(const Plane& plane, const std::vector<Eigen::Vector3f>& points_m) {
  std::vector<double> distances_m;
  for (const Eigen::Vector3f& p_m : points_m) distances_m.push_back(plane.signed_distance_m(p_m.cast<double>()));
  std::sort(distances_m.begin(), distances_m.end());
  return distances_m[distances_m.size() * 9 / 10] - distances_m[distances_m.size() / 10];
}

/// The plane of total least squares, each point with the same weight.
Plane least_squares(const std::vector<Eigen::Vector3f>& points_m) {
  const Eigen::Vector3d origin_m = points_m.front().cast<double>();
  Moments sum;
  for (const Eigen::Vector3f& p_m : points_m) {
    const Eigen::Vector3d from_origin_m = p_m.cast<double>() - origin_m;
    sum.add(Moments{1.0, from_origin_m, Symmetric3::outer(from_origin_m)});
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum.covariance());
  return Plane::through(origin_m + sum.mean(), solver.eigenvectors().col(0));
}

PlanePair pair_of(const MapSnapshot& map, const std::vector<PointLabel>& labels,
                  const std::vector<Eigen::Vector3f>& cloud_m, const RansacPlane& ransac) {
  PlanePair pair;
  pair.inliers = ransac.inliers.size();
  std::map<PlaneId, std::size_t> votes;
  std::size_t uncertain = 0;
  for (const std::uint32_t i : ransac.inliers) {
    ++votes[labels[i].plane];
    if (labels[i].uncertain) ++uncertain;
  }
  const auto share = [&](std::size_t count) { return static_cast<double>(count) / static_cast<double>(pair.inliers); };
  pair.uncertain_share = share(uncertain);
  pair.no_plane_share = share(votes[kNoPlane]);
  votes.erase(kNoPlane);
  for (const auto& [plane, count] : votes) {
    if (share(count) > pair.share) {
      pair.next_share = pair.share;
      pair.share = share(count);
      pair.plane = plane;
    } else {
      pair.next_share = std::max(pair.next_share, share(count));
    }
  }
  if (pair.plane == kNoPlane) return pair;
  const Plane& ours = map.find(pair.plane)->plane;
  pair.normal_deg = degrees_between(ours, ransac.plane);
  pair.offset_m = mean_distance_m(ours, ransac, cloud_m);
  return pair;
}

}  // namespace

double degrees_between(const Plane& a, const Plane& b) {
  return std::atan2(a.normal().cross(b.normal()).norm(), std::abs(a.normal().dot(b.normal()))) * kDegPerRad;
}

std::vector<PointLabel> label_points(const MapSnapshot& map, const std::vector<Eigen::Vector3f>& cloud_m,
                                     double max_deviation_deg) {
  const CellFinder cells(map);
  std::vector<PointLabel> labels;
  labels.reserve(cloud_m.size());
  for (const Eigen::Vector3f& p_m : cloud_m) {
    const CellView* cell = cells.cell_of(p_m.cast<double>());
    PointLabel label;
    if (cell != nullptr) {
      label.plane = cell->plane_id;
      label.uncertain =
          cell->plane_id == kNoPlane && (!cell->normal || cell->deviation_rad * kDegPerRad > max_deviation_deg);
    }
    labels.push_back(label);
  }
  return labels;
}

std::size_t PlaneComparison::matched() const {
  return static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), [](const auto& p) { return p.matched(); }));
}

double PlaneComparison::mean_normal_deg() const {
  double sum_deg = 0.0;
  for (const PlanePair& pair : pairs) sum_deg += pair.matched() ? pair.normal_deg : 0.0;
  return matched() > 0 ? sum_deg / static_cast<double>(matched()) : 0.0;
}

double PlaneComparison::max_normal_deg() const {
  double max_deg = 0.0;
  for (const PlanePair& pair : pairs) max_deg = std::max(max_deg, pair.matched() ? pair.normal_deg : 0.0);
  return max_deg;
}

PlaneComparison compare_planes(const MapSnapshot& map, const std::vector<PointLabel>& labels,
                               const std::vector<Eigen::Vector3f>& cloud_m, const std::vector<RansacPlane>& ransac) {
  PlaneComparison comparison;
  for (const RansacPlane& plane : ransac) comparison.pairs.push_back(pair_of(map, labels, cloud_m, plane));
  return comparison;
}

std::vector<OwnSurface> ransac_on_own_surfaces(const MapSnapshot& map, const std::vector<PointLabel>& labels,
                                               const std::vector<Eigen::Vector3f>& cloud_m, std::size_t planes,
                                               const RansacConfig& config) {
  std::map<PlaneId, std::vector<Eigen::Vector3f>> points_m;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i].plane != kNoPlane) points_m[labels[i].plane].push_back(cloud_m[i]);
  }
  std::vector<OwnSurface> surfaces;
  for (const auto& [id, own_m] : points_m) {
    surfaces.push_back({id, own_m.size(), thickness_m(map.find(id)->plane, own_m), 0.0, 0.0, 0.0});
  }
  std::stable_sort(surfaces.begin(), surfaces.end(),
                   [](const OwnSurface& a, const OwnSurface& b) { return a.points > b.points; });
  surfaces.resize(std::min(surfaces.size(), planes));
  RansacConfig one = config;
  one.planes = 1;
  for (OwnSurface& surface : surfaces) {
    const Plane& ours = map.find(surface.plane)->plane;
    surface.fit_deg = degrees_between(ours, least_squares(points_m[surface.plane]));
    const std::vector<RansacPlane> found = ransac_planes(points_m[surface.plane], one);
    if (found.empty()) continue;
    surface.inlier_share = static_cast<double>(found.front().inliers.size()) / static_cast<double>(surface.points);
    surface.normal_deg = degrees_between(ours, found.front().plane);
  }
  return surfaces;
}

double mean_skew_deg(const std::vector<Plane>& planes) {
  double sum_deg = 0.0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j, ++pairs) {
      const double deg = degrees_between(planes[i], planes[j]);
      sum_deg += std::min(deg, 90.0 - deg);
    }
  }
  return pairs > 0 ? sum_deg / static_cast<double>(pairs) : 0.0;
}

std::vector<KnownError> errors_of_pairs(const MapSnapshot& map, const PlaneComparison& comparison,
                                        const std::vector<Eigen::Vector3f>& cloud_m,
                                        const std::vector<RansacPlane>& ransac, const std::vector<Plane>& truth) {
  std::vector<KnownError> errors;
  for (std::size_t i = 0; i < comparison.pairs.size() && !truth.empty(); ++i) {
    if (!comparison.pairs[i].matched()) continue;
    const Plane& nearest = *std::min_element(truth.begin(), truth.end(), [&](const Plane& a, const Plane& b) {
      return mean_distance_m(a, ransac[i], cloud_m) < mean_distance_m(b, ransac[i], cloud_m);
    });
    errors.push_back({degrees_between(map.find(comparison.pairs[i].plane)->plane, nearest),
                      degrees_between(ransac[i].plane, nearest)});
  }
  return errors;
}

}  // namespace planemap::experiments

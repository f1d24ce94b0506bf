#include "planemap/coplanar.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "angles.hpp"

namespace planemap {

namespace {

constexpr double kChiSquare95 = 7.815;  // three degrees of freedom
constexpr double kOffsetFloorM = 0.005;
constexpr double kTiltFloorRad = 0.5 * kRadPerDeg;
constexpr double kMaxOffsetSigmaM = 0.02;
constexpr double kMaxTiltSigmaRad = 1.5 * kRadPerDeg;
constexpr double kLeastArmM = 1.0;

// What are_coplanar() can allow at most, sqrt(chi^2 (sigma^2 + floor^2)): 5.8 cm of distance at each end and 4.5
// degrees of turn, hence 2 * 5.8 cm on the least arm of 1 m of tilt: the search looks no farther.
constexpr double kMaxOffsetM = 0.058;
constexpr double kMaxTurnRad = 0.078;
constexpr double kMaxTilt = 2.0 * kMaxOffsetM / kLeastArmM;
constexpr double kMaxChord = kMaxTilt + kMaxTurnRad;  // between unit normals; no less than their root of squares

/// Which cube of normals a plane is in, and where it is along its own.
struct Entry {
  std::uint32_t cube = 0;
  double d_m = 0.0;  ///< from the middle of the map
  std::size_t plane = 0;

  bool operator<(const Entry& other) const { return cube != other.cube ? cube < other.cube : d_m < other.d_m; }
};

/// Names the cube of edge kMaxChord that holds a normal, or one beside it.
std::uint32_t cube_of(const Eigen::Vector3d& normal, const std::array<int, 3>& step) {
  std::uint32_t cube = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int index = static_cast<int>(std::floor(normal[axis] / kMaxChord)) + step[static_cast<std::size_t>(axis)];
    cube = (cube << 8U) | static_cast<std::uint32_t>(index + 128);
  }
  return cube;
}

/// Calls visit(i, j) once for each two planes that may be coplanar, i < j.
template <class Visit>
void for_each_near_pair(const std::vector<const PlaneRecord*>& planes, Visit&& visit) {
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  for (const PlaneRecord* plane : planes) middle_m += plane->centroid_m / static_cast<double>(planes.size());
  double radius_m = kLeastArmM;
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    radius_m = std::max(radius_m, (planes[i]->centroid_m - middle_m).norm());
    const Plane& plane = planes[i]->plane;
    entries.push_back({cube_of(plane.normal(), {0, 0, 0}), plane.signed_distance_m(middle_m), i});
  }
  std::sort(entries.begin(), entries.end());
  // Between two centroids the planes are at most kMaxOffsetM apart; seen from the middle, the turn comes on top.
  const double reach_m = kMaxOffsetM + kMaxChord * radius_m;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Plane& plane = planes[i]->plane;
    const double d_m = plane.signed_distance_m(middle_m);
    for (int number = 0; number < 27; ++number) {
      const std::uint32_t cube = cube_of(plane.normal(), {number % 3 - 1, number / 3 % 3 - 1, number / 9 - 1});
      auto entry = std::lower_bound(entries.begin(), entries.end(), Entry{cube, d_m - reach_m, 0});
      for (; entry != entries.end() && entry->cube == cube && entry->d_m <= d_m + reach_m; ++entry) {
        if (entry->plane > i) visit(i, entry->plane);
      }
    }
  }
}

}  // namespace

bool are_coplanar(const PlaneRecord& a, const PlaneRecord& b) {
  if (a.plane.normal().dot(b.plane.normal()) <= 0.0) return false;
  Eigen::Vector4d difference;
  difference << a.plane.normal() - b.plane.normal(), a.plane.d() - b.plane.d();
  const Eigen::Vector3d middle_m = 0.5 * (a.centroid_m + b.centroid_m);
  // Half-way between the ends no covariance allows more, and here most pairs end.
  if (std::abs(difference.dot(middle_m.homogeneous())) > kMaxOffsetM) return false;
  const Eigen::Vector3d normal = (a.plane.normal() + b.plane.normal()).normalized();
  Eigen::Vector3d along_m = b.centroid_m - a.centroid_m;
  along_m -= normal.dot(along_m) * normal;
  const double arm_m = along_m.norm();
  const Eigen::Vector3d along = arm_m > 1e-6 ? Eigen::Vector3d(along_m / arm_m) : normal.unitOrthogonal();
  const Eigen::Vector3d end_m = 0.5 * std::max(arm_m, kLeastArmM) * along;
  Eigen::Matrix<double, 3, 4> seen;  // of (n, d): distance at either end, turn about the line between
  seen << (middle_m - end_m).transpose(), 1.0, (middle_m + end_m).transpose(), 1.0, normal.cross(along).transpose(),
      0.0;
  const Eigen::Vector3d error = seen * difference;
  Eigen::Matrix3d covariance = seen * (a.covariance + b.covariance) * seen.transpose();
  if (!(std::max(covariance(0, 0), covariance(1, 1)) <= kMaxOffsetSigmaM * kMaxOffsetSigmaM &&
        covariance(2, 2) <= kMaxTiltSigmaRad * kMaxTiltSigmaRad)) {
    return false;
  }
  constexpr double kOffsetFloorM2 = kOffsetFloorM * kOffsetFloorM;
  covariance.diagonal() += Eigen::Vector3d(kOffsetFloorM2, kOffsetFloorM2, kTiltFloorRad * kTiltFloorRad);
  return error.dot(covariance.inverse() * error) <= kChiSquare95;
}

CoplanarLinks coplanar_links(std::span<const SizedPlane> planes) {
  std::vector<const PlaneRecord*> large;
  for (const SizedPlane& plane : planes) {
    if (plane.area_m2 >= kLeastLinkedAreaM2) large.push_back(plane.record);
  }
  CoplanarLinks links;
  for_each_near_pair(large, [&](std::size_t i, std::size_t j) {
    if (!are_coplanar(*large[i], *large[j])) return;
    links[large[i]->id].push_back(large[j]->id);
    links[large[j]->id].push_back(large[i]->id);
  });
  for (auto& entry : links) std::sort(entry.second.begin(), entry.second.end());
  return links;
}

std::vector<PlaneId> coplanar_with(std::span<const SizedPlane> planes, std::size_t plane) {
  std::vector<PlaneId> linked;
  if (planes[plane].area_m2 < kLeastLinkedAreaM2) return linked;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (i == plane || planes[i].area_m2 < kLeastLinkedAreaM2) continue;
    // In the order in which coplanar_links() compares them, so that both round alike.
    const auto [first, second] = std::minmax(i, plane);
    if (are_coplanar(*planes[first].record, *planes[second].record)) linked.push_back(planes[i].record->id);
  }
  std::sort(linked.begin(), linked.end());
  return linked;
}

CoplanarLinks coplanar_links(const MapSnapshot& snapshot) {
  const double cell_m2 = snapshot.cell_size_m() * snapshot.cell_size_m();
  std::vector<SizedPlane> planes;
  for (const auto& record : snapshot.planes()) planes.push_back({record.get(), record->cell_count * cell_m2});
  return coplanar_links(planes);
}

}  // namespace planemap

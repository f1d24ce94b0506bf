#include "joined_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace planemap::accuracy {

namespace {

double distance_to_segment_m(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - share * along).norm();
}

/// Least distance of the corners of one piece to the border of another.
double gap_m(const simulation::ConvexPiece& corners_m, const simulation::ConvexPiece& border_m) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& p : corners_m) {
    for (std::size_t i = 0; i < border_m.size(); ++i) {
      least_m = std::min(least_m, distance_to_segment_m(p, border_m[i], border_m[(i + 1) % border_m.size()]));
    }
  }
  return least_m;
}

/// Of pieces that lie in one plane and don't overlap, one has a corner where they are nearest.
bool touch(const simulation::Surface& a, const simulation::Surface& b) {
  return std::any_of(a.pieces_m.begin(), a.pieces_m.end(), [&](const simulation::ConvexPiece& piece_a) {
    return std::any_of(b.pieces_m.begin(), b.pieces_m.end(), [&](const simulation::ConvexPiece& piece_b) {
      return std::min(gap_m(piece_a, piece_b), gap_m(piece_b, piece_a)) <= kTouchingGap_m;
    });
  });
}

}  // namespace

bool are_one_surface(const simulation::Surface& a, const simulation::Surface& b) {
  if (a.facet || b.facet) return false;
  const bool a_is_smaller = simulation::area_m2(a) < simulation::area_m2(b);
  const simulation::Surface& smaller = a_is_smaller ? a : b;
  const Plane& larger = (a_is_smaller ? b : a).plane;
  const Eigen::Vector3d& normal = smaller.plane.normal();
  const double angle_rad = std::atan2(normal.cross(larger.normal()).norm(), normal.dot(larger.normal()));
  if (angle_rad >= kResolvedAngle_deg * std::numbers::pi / 180.0) return false;
  for (const simulation::ConvexPiece& piece : smaller.pieces_m) {
    for (const Eigen::Vector3d& corner : piece) {
      if (std::abs(larger.signed_distance_m(corner)) >= kResolvedOffset_m) return false;
    }
  }
  return touch(a, b);
}

std::vector<std::size_t> joined_surfaces(const std::vector<simulation::Surface>& surfaces) {
  std::vector<std::size_t> by_area(surfaces.size());
  std::iota(by_area.begin(), by_area.end(), std::size_t{0});
  std::stable_sort(by_area.begin(), by_area.end(), [&](std::size_t i, std::size_t j) {
    return simulation::area_m2(surfaces[i]) > simulation::area_m2(surfaces[j]);
  });
  std::vector<std::size_t> whole(surfaces.size());
  std::iota(whole.begin(), whole.end(), std::size_t{0});
  for (std::size_t k = 0; k < by_area.size(); ++k) {
    const std::size_t small = by_area[k];
    const auto end = by_area.begin() + static_cast<std::ptrdiff_t>(k);
    const auto found = std::find_if(by_area.begin(), end, [&](std::size_t large) {
      return whole[large] == large && are_one_surface(surfaces[small], surfaces[large]);
    });
    if (found != end) whole[small] = *found;
  }
  return whole;
}

}  // namespace planemap::accuracy

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <planemap/config.hpp>
#include <planemap/snapshot.hpp>
#include <vector>

#include "real/ransac_planes.hpp"

namespace planemap::experiments {

/// What a map says of a point.
struct PointLabel {
  PlaneId plane = kNoPlane;
  bool uncertain = false;  ///< its cell is in no plane, and has no normal or one that deviates by more than is allowed
};

/// Gives each point the label of its cell: of the dense cells around it, the one with the least expected distance (Eq.
/// 7).
/// @param max_deviation_deg  as normals.max_deviation_deg
std::vector<PointLabel> label_points(const MapSnapshot& map, const std::vector<Eigen::Vector3f>& cloud_m,
                                     double max_deviation_deg);

/// One RANSAC plane beside the map's plane that shares most of its inliers.
struct PlanePair {
  std::size_t inliers = 0;
  PlaneId plane = kNoPlane;      ///< that holds most of the inliers
  double share = 0.0;            ///< of the inliers in it
  double next_share = 0.0;       ///< of the inliers in the plane that comes second
  double uncertain_share = 0.0;  ///< of the inliers in cells that were left out for their normals
  double no_plane_share = 0.0;   ///< of the inliers in no plane, those included
  double normal_deg = 0.0;       ///< between the two normals, 0 to 90
  double offset_m = 0.0;         ///< mean distance of the inliers to the map's plane

  static constexpr double kLeastShare = 0.5;
  bool matched() const { return plane != kNoPlane && share >= kLeastShare; }
};

/// The paper's comparison: planes are associated, their normals compared.
struct PlaneComparison {
  std::vector<PlanePair> pairs;  ///< by RANSAC plane, most inliers first

  std::size_t matched() const;
  /// Over the matched ones, each counting the same; degrees. 0 where none is matched.
  double mean_normal_deg() const;
  double max_normal_deg() const;
};

PlaneComparison compare_planes(const MapSnapshot& map, const std::vector<PointLabel>& labels,
                               const std::vector<Eigen::Vector3f>& cloud_m, const std::vector<RansacPlane>& ransac);

/// One plane of the map beside RANSAC's, which was given the points of that plane alone: what is left of the difference
/// without the rest of the room.
struct OwnSurface {
  PlaneId plane = kNoPlane;
  std::size_t points = 0;
  double thickness_m = 0.0;   ///< the middle 80 % of the points lie within, about the map's plane
  double inlier_share = 0.0;  ///< of the points that RANSAC took
  double normal_deg = 0.0;    ///< between the map's normal and RANSAC's, 0 to 90
  double fit_deg = 0.0;       ///< between the map's normal and that of total least squares over all the points
};

/// The planes with most points, most first.
std::vector<OwnSurface> ransac_on_own_surfaces(const MapSnapshot& map, const std::vector<PointLabel>& labels,
                                               const std::vector<Eigen::Vector3f>& cloud_m, std::size_t planes,
                                               const RansacConfig& config);

/// Angle between two planes, whichever sides their normals point to; degrees, 0 to 90.
double degrees_between(const Plane& a, const Plane& b);

/// How far the angles between planes are from the nearer of 0 and 90 degrees, mean over all pairs: rooms and what
/// stands in them are square, whoever maps them. 0 for fewer than two planes.
double mean_skew_deg(const std::vector<Plane>& planes);

/// A matched pair beside the known plane of its surface.
struct KnownError {
  double ours_deg = 0.0;
  double ransac_deg = 0.0;
};
/// Of each matched pair whose surface is known: the true plane that the inliers are nearest to.
std::vector<KnownError> errors_of_pairs(const MapSnapshot& map, const PlaneComparison& comparison,
                                        const std::vector<Eigen::Vector3f>& cloud_m,
                                        const std::vector<RansacPlane>& ransac, const std::vector<Plane>& truth);

}  // namespace planemap::experiments

#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <planemap/moments.hpp>

namespace planemap {

/// What one scan adds to a cell; points are taken relative to the cell's geometric centre, which keeps the digits.
struct ScanSums {
  Moments points;                                      ///< each with weight 1
  Eigen::Vector3d error_m2 = Eigen::Vector3d::Zero();  ///< sum of squared standard errors along the world's axes
  Eigen::Vector3f view = Eigen::Vector3f::Zero();      ///< sum over the points of unit vectors towards the sensor

  double count() const { return points.weight; }
  /// Weight of each point as evidence of a plane with that unit normal: 1 / sigma^2. Points without error are taken as
  /// good to a tenth of a millimetre. @pre count() > 0
  double point_weight(const Eigen::Vector3d& normal) const {
    constexpr double kLeastVariance = 1e-8;
    return 1.0 / std::max(normal.cwiseAbs2().dot(error_m2) / count(), kLeastVariance);
  }
};

/// Cell statistics of Definition 1. Points are taken relative to the cell's geometric centre. The sums of two maps with
/// the same grid add.
struct CellSums {
  double count = 0.0;                                   ///< d(u) = n
  Eigen::Vector3d first_m = Eigen::Vector3d::Zero();    ///< L
  Eigen::Vector3f square_m2 = Eigen::Vector3f::Zero();  ///< S
  Eigen::Vector3f error_m2 = Eigen::Vector3f::Zero();   ///< S_s: sum of squared standard errors along the world's axes
  Eigen::Vector3f view = Eigen::Vector3f::Zero();       ///< sum over the points of unit vectors towards the sensor

  void add(const ScanSums& scan) {
    count += scan.points.weight;
    first_m += scan.points.first;
    const auto& second = scan.points.second.e;
    square_m2 += Eigen::Vector3d(second[0], second[3], second[5]).cast<float>();
    error_m2 += scan.error_m2.cast<float>();
    view += scan.view;
  }
  /// The virtual centre from the geometric one, E[C_u] = L / n (Eq. 1). @pre count > 0
  Eigen::Vector3d mean_m() const { return first_m / count; }
  /// Mean variance of a point along a unit vector, square metres. @pre count > 0
  double point_variance(const Eigen::Vector3d& direction) const {
    return direction.cwiseAbs2().dot(error_m2.cast<double>()) / count;
  }
};

/// Names a plane within one mapper; 0 is none.
using PlaneSlot = std::uint32_t;
constexpr PlaneSlot kNoSlot = 0;

/// What the map knows of one cube of space.
struct Cell {
  static constexpr std::uint32_t kNotWorking = 0xffffffff;
  static constexpr std::uint16_t kNoSecond = 0xffff;

  CellSums sums;
  /// The points as evidence of a plane: their full second moment, each weighted by 1 / sigma^2 along the normal of its
  /// time. One weight for all scans (the cell's mean error, say) would shift planes by up to a millimetre: where the
  /// noise of far looks spreads a wall over three layers of cells, the middle one also holds near looks, and would
  /// count its share of the far ones for more than the outer layers count theirs.
  PackedMoments evidence;
  float evidence_count = 0.0F;                       ///< points, those that are trusted less for less than one
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< uncertain normal (Definition 3); zero: not known
  float deviation_rad = 0.0F;                        ///< its deviation by the min-max approach
  float normal_count = 0.0F;                         ///< points when the normal was last fitted
  float plane_weight = 0.0F;  ///< share of its evidence, 0 to 1, that shapes its plane; 0: edge member
  PlaneSlot plane = kNoSlot;
  std::uint32_t working = kNotWorking;  ///< place in the working set while a scan is assigned

  std::uint16_t second = kNoSecond;  ///< ordinal, in the same block, of the cell with this one's other surface
  bool is_second = false;            ///< this is such a cell

  /// Forgets its points, and all that was made of them, but for its label.
  void begin_anew() {
    Cell fresh;
    fresh.plane = plane;
    fresh.working = working;
    fresh.second = second;
    fresh.is_second = is_second;
    *this = fresh;
  }
  /// Forgets what its points are evidence of, and the normal; the points stay.
  void begin_evidence_anew() {
    evidence = {};
    evidence_count = 0.0F;
    normal.setZero();
    deviation_rad = normal_count = plane_weight = 0.0F;
  }
  bool has_normal() const { return normal.squaredNorm() > 0.5F; }
  /// Along which its points count as evidence while it has no plane: its own normal, or else the line of sight. Unit.
  Eigen::Vector3d direction(const ScanSums& scan) const {
    return (has_normal() ? normal : scan.view).cast<double>().normalized();
  }
  /// Takes in what a scan adds.
  /// @param along  unit; that its points count as evidence along: the normal of the cell's plane, or direction()
  /// @param trust   that the evidence deserves, above 0, at most 1
  void add(const ScanSums& scan, const Eigen::Vector3d& along, double trust = 1.0) {
    sums.add(scan);
    evidence.add(scan.points, trust * scan.point_weight(along));
    evidence_count += static_cast<float>(trust * scan.count());
  }
  bool has_evidence() const { return evidence.weight > 0.0F; }
  /// Variance of a point along the normal as its evidence is weighted: the harmonic mean. @pre evidence_count > 0
  double evidence_variance_m2() const { return static_cast<double>(evidence_count / evidence.weight); }
};

}  // namespace planemap

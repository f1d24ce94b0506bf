#pragma once

#include <Eigen/Core>
#include <optional>
#include <planemap/cell.hpp>
#include <planemap/config.hpp>
#include <planemap/plane.hpp>

namespace planemap {

/// A plane fitted to evidence.
struct PlaneFit {
  Plane plane = Plane::through(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();  ///< on the plane, world frame
  Eigen::Vector3d tangent_1 = Eigen::Vector3d::UnitX();  ///< direction of least spread within the plane
  Eigen::Vector3d tangent_2 = Eigen::Vector3d::UnitY();  ///< direction of greatest spread
  double spread_1_m2 = 0.0;                              ///< variance of the evidence along tangent_1
  double spread_2_m2 = 0.0;                              ///< and along tangent_2
  double residual_m2 = 0.0;                              ///< and along the normal
  double deviation_rad = 0.0;                            ///< of the normal
  double weight = 0.0;                                   ///< of the evidence: the sum of 1 / sigma^2, 1/m2
  double tilt_1_rad2 = 0.0;  ///< variance of the tilt along tangent_1, by the errors of the evidence
  double tilt_2_rad2 = 0.0;  ///< and along tangent_2
  /// Mean square distance of the means of its cells to the plane, in units of what their points' errors make of it:
  /// chi squared of the cells per degree of freedom. 1 where the points' errors are all there is; 0: not measured.
  double cell_dispersion = 0.0;

  /// Width and length of the uniform rectangle with these spreads, metres.
  double width_m() const;
  double extent_m() const;
};

/// What is known of a set of cells as one plane: sums, so cells can join and leave (paper, section IV.B: "plane
/// statistics similarly to cell statistics").
class PlaneStatistics {
 public:
  explicit PlaneStatistics(const Eigen::Vector3d& origin_m) : origin_m_(origin_m) {}

  /// Takes a cell in, with cell.plane_weight as the share of its evidence, or out: then exactly as it was taken in.
  /// @param centre_m  the cell's geometric centre
  void add(const Cell& cell, const Eigen::Vector3d& centre_m) {
    accumulate(cell, centre_m, 1.0, static_cast<double>(cell.plane_weight));
  }
  void remove(const Cell& cell, const Eigen::Vector3d& centre_m) {
    accumulate(cell, centre_m, -1.0, static_cast<double>(cell.plane_weight));
  }
  /// Takes a cell in with all of its evidence.
  void add_whole(const Cell& cell, const Eigen::Vector3d& centre_m) { accumulate(cell, centre_m, 1.0, 1.0); }
  /// Takes in all that another set holds.
  void add(const PlaneStatistics& other);

  const Eigen::Vector3d& origin_m() const { return origin_m_; }  ///< that its moments are about, world frame
  std::size_t cell_count() const { return static_cast<std::size_t>(cells_); }
  double point_count() const { return points_; }
  double core_point_count() const { return core_points_; }
  const Moments& evidence() const { return pooled_; }  ///< its points, weighted, about origin_m()
  double weight() const { return pooled_.weight; }
  /// Variance of a point along the normal as the evidence is weighted: the harmonic mean. @pre weight() > 0
  double evidence_variance_m2() const { return evidence_count_ / pooled_.weight; }
  const Eigen::Vector3d& view() const { return view_; }

  /// Fits the plane. Pooled: to the weighted second moments of the points. Otherwise as the paper: the mean of the
  /// cells' normals, through the mean of the virtual centres. Empty where the cells span no plane.
  std::optional<PlaneFit> fit(bool pooled) const;
  /// Length of the uniform strip over which its cells spread, metres, whatever evidence each of them has: a plane is as
  /// large where it was seen from afar. @pre cell_count() > 0
  double cells_extent_m() const;
  /// Mean square distance of the evidence to a plane, square metres. @pre weight() > 0
  double mean_square_distance_m2(const Plane& plane) const {
    return pooled_.mean_square_distance(plane.normal(), plane.signed_distance_m(origin_m_));
  }

  /// Calls visit(number) for each number it is made of: to write it down, and to take it in again to the bit.
  template <MaybeConst<PlaneStatistics> Self, class Visit>
  static void visit_numbers(Self& self, Visit&& visit) {
    const auto moments = [&](auto& m) {
      visit(m.weight);
      for (auto& x : m.first) visit(x);
      for (auto& x : m.second.e) visit(x);
    };
    for (auto& x : self.origin_m_) visit(x);
    moments(self.pooled_);
    for (auto& x : self.means_.e) visit(x);
    moments(self.centres_);
    for (auto& x : self.normal_sum_) visit(x);
    visit(self.deviation_sum_rad2_);
    visit(self.normals_);
    for (auto& x : self.view_) visit(x);
    for (auto* x : {&self.cells_, &self.points_, &self.core_points_, &self.evidence_count_, &self.core_cells_})
      visit(*x);
  }

 private:
  void accumulate(const Cell& cell, const Eigen::Vector3d& centre_m, double sign, double share);
  std::optional<PlaneFit> fit_pooled() const;
  std::optional<PlaneFit> fit_normals() const;
  double normal_deviation_rad() const;
  double cell_dispersion(const Plane& plane) const;

  Eigen::Vector3d origin_m_;
  Moments pooled_;                                        ///< points, weighted, about origin_m_
  Symmetric3 means_;                                      ///< second moment of the cells' means, weighted, likewise
  Moments centres_;                                       ///< virtual centres, each with weight 1, about origin_m_
  Eigen::Vector3d normal_sum_ = Eigen::Vector3d::Zero();  ///< Definition 1's L, of normals
  double deviation_sum_rad2_ = 0.0;                       ///< Definition 1's S_s, of normals
  double normals_ = 0.0;                                  ///< Definition 1's n, of normals
  Eigen::Vector3d view_ = Eigen::Vector3d::Zero();
  double cells_ = 0.0;
  double points_ = 0.0;
  double core_points_ = 0.0;
  double evidence_count_ = 0.0;  ///< points, by the share and the trust with which they count
  double core_cells_ = 0.0;
};

/// Expected squared distance of two uncertain unit normals, by Eq. 7: |a - b|^2 and both variances.
inline double expected_squared_distance(const Eigen::Vector3d& a, double deviation_a_rad, const Eigen::Vector3d& b,
                                        double deviation_b_rad) {
  return (a - b).squaredNorm() + deviation_a_rad * deviation_a_rad + deviation_b_rad * deviation_b_rad;
}

/// The squared distance of two unit normals with an angle between them: (2 sin(angle / 2))^2.
double squared_chord(double angle_rad);

/// Covariance of (tilt_1, tilt_2, offset at the centroid) of a fit whose weights are 1 / sigma^2, about its tangents;
/// what the errors of its evidence make of it. Where the means of its cells scatter about the plane by more than the
/// errors of their points allow, the covariance grows by as much (Birge's ratio), and cells that lie side by side are
/// taken to err together. Radians and metres.
/// @param offset_floor_m  standard error of the offset that is added to what the points say; the tilts get it at half
/// the extent
Eigen::Matrix3d sensor_covariance(const PlaneFit& fit, double offset_floor_m);

/// Covariance of (nx, ny, nz, d) from one of (tilt_1, tilt_2, offset at the centroid); rank 3.
Eigen::Matrix4d covariance_of(const PlaneFit& fit, const Eigen::Matrix3d& covariance);

}  // namespace planemap

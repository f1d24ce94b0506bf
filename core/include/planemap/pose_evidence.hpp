#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <planemap/config.hpp>
#include <planemap/moments.hpp>
#include <planemap/plane_statistics.hpp>
#include <planemap/pose_covariance.hpp>

namespace planemap {

/// One scan's place in space and time.
struct ScanPose {
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
  std::int64_t utime = 0;                      ///< microseconds
  std::optional<PoseCovariance> covariance{};  ///< of T_world_sensor; empty: as configured

  PoseCovariance covariance_or(const PoseErrorConfig& config) const {
    return covariance ? *covariance : configured_covariance(config);
  }
};

/// What the errors of the poses make of a plane's parameters.
///
/// All points of a scan share its pose's error x_k (translation and small rotation in the sensor frame, 6 numbers), and
/// successive scans share some of theirs. With X_k = L_k L_k^T the covariance of the scan's pose (Cholesky), x_k = L_k
/// z_k, where z is six first-order Gauss-Markov processes of unit variance: the errors of scans dt apart have the
/// covariance rho_kl L_k L_l^T, rho_kl = exp(-dt / correlation_s). An error moves a point's distance to the plane by
/// g(p) . x_k, which is affine in the point: g(p) = G_k a, a = (p - origin, 1). The least-squares plane then moves by
/// A^-1 sum_k B_k z_k with A = sum_k M_k, B_k = M_k G_k^T L_k, M_k = sum over the scan's points of w a a^T, and has the
/// covariance A^-1 S A^-1, S = sum_k sum_l rho_kl B_k B_l^T. S grows with each scan by a recursion, since rho is a
/// product over the times between: it is right at any moment and costs the same each time.
class PoseEvidence {
 public:
  /// Takes in what a scan changed: points that it saw, and cells that joined the plane, left it or count for more or
  /// less than before. All of that is taken to have the error of this scan's pose, for a cell doesn't know which scans
  /// saw it: most cells join soon after they were first seen, and of evidence that goes some of its error is taken to
  /// stay, which overstates it. So M_k is what the plane holds after the scan less what it held before, and A is always
  /// the fit's own. Scans come in the order in which they are mapped.
  /// @param held      moments about the origin of all points of the plane now, with their weights in it
  /// @param normal    of the plane, unit
  /// @param origin_m  that all moments are about, world frame; the same for each call
  void update(const Moments& held, const Eigen::Vector3d& normal, const Eigen::Vector3d& origin_m, const ScanPose& scan,
              const PoseErrorConfig& config);
  /// Adds that of another plane. How far the two share their errors is not kept: they are taken to share them all.
  /// @param shift_m  the other's origin minus ours
  void add(const PoseEvidence& other, const Eigen::Vector3d& shift_m, const PoseErrorConfig& config);

  /// Covariance of (tilt_1, tilt_2, offset at the centroid) of a fit, about its tangents; radians and metres.
  /// @param of_one_scan  where the evidence spans no plane, it is taken to be as wrong as a scan of this pose
  Eigen::Matrix3d covariance(const PlaneFit& fit, const Eigen::Vector3d& origin_m,
                             const PoseCovariance& of_one_scan) const;

  /// Calls visit(number) for each number it is made of: to write it down, and to take it in again to the bit.
  template <MaybeConst<PoseEvidence> Self, class Visit>
  static void visit_numbers(Self& self, Visit&& visit) {
    for (Eigen::Index i = 0; i < 16; ++i) visit(self.normal_equations_.data()[i]);
    for (Eigen::Index i = 0; i < 16; ++i) visit(self.spread_.data()[i]);
    for (Eigen::Index i = 0; i < 24; ++i) visit(self.carried_.data()[i]);
    visit(self.utime_);
  }

 private:
  using Matrix46 = Eigen::Matrix<double, 4, 6>;

  void pass_time(std::int64_t utime, const PoseErrorConfig& config);

  Eigen::Matrix4d normal_equations_ = Eigen::Matrix4d::Zero();  ///< A
  Eigen::Matrix4d spread_ = Eigen::Matrix4d::Zero();            ///< S
  Matrix46 carried_ = Matrix46::Zero();                         ///< sum of rho(now, k) B_k: what the next scan shares
  std::int64_t utime_ = 0;                                      ///< that carried_ stands for
};

}  // namespace planemap

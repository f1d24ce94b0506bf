#pragma once

#include <Eigen/Core>
#include <array>

namespace planemap {

/// Symmetric 3x3 matrix: xx, xy, xz, yy, yz, zz.
struct Symmetric3 {
  std::array<double, 6> e{};

  static Symmetric3 outer(const Eigen::Vector3d& v) {
    return {{v.x() * v.x(), v.x() * v.y(), v.x() * v.z(), v.y() * v.y(), v.y() * v.z(), v.z() * v.z()}};
  }
  /// Adds other, times scale.
  void add(const Symmetric3& other, double scale) {
    for (std::size_t i = 0; i < 6; ++i) e[i] += scale * other.e[i];
  }
  Eigen::Matrix3d matrix() const {
    Eigen::Matrix3d m;
    m << e[0], e[1], e[2], e[1], e[3], e[4], e[2], e[4], e[5];
    return m;
  }
  /// v^T M v
  double quadratic(const Eigen::Vector3d& v) const {
    return v.x() * (e[0] * v.x() + 2.0 * (e[1] * v.y() + e[2] * v.z())) + v.y() * (e[3] * v.y() + 2.0 * e[4] * v.z()) +
           v.z() * e[5] * v.z();
  }
};

/// Weighted sums of points about a reference point that their owner knows: sum w, sum w (p - r), sum w (p - r)(p -
/// r)^T. Plain sums, so evidence adds up and can be taken away again.
struct Moments {
  double weight = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  ///< metres
  Symmetric3 second;                                ///< square metres

  /// Adds other, each of its points with the given weight.
  /// @param shift_m  other's reference point minus ours
  void add(const Moments& other, double scale, const Eigen::Vector3d& shift_m);
  /// Adds other, whose reference point is ours.
  void add(const Moments& other) {
    weight += other.weight;
    first += other.first;
    for (std::size_t i = 0; i < 6; ++i) second.e[i] += other.second.e[i];
  }

  /// Mean of the points, from the reference point. @pre weight > 0
  Eigen::Vector3d mean() const { return first / weight; }
  /// Second moment about the mean, divided by the weight: square metres. @pre weight > 0
  Eigen::Matrix3d covariance() const;
  /// Mean square of (normal . (p - r) + d). @pre weight > 0
  double mean_square_distance(const Eigen::Vector3d& normal, double d) const {
    return (second.quadratic(normal) + 2.0 * d * normal.dot(first)) / weight + d * d;
  }
};

/// Moments in floats, for cells: their points are no farther than a few centimetres from the reference point, so a
/// float's digits are a thousandth of any sensor's error.
struct PackedMoments {
  float weight = 0.0F;
  Eigen::Vector3f first = Eigen::Vector3f::Zero();
  std::array<float, 6> second{};

  /// Adds moments about the same reference point, each point with the given weight.
  void add(const Moments& other, double scale) {
    weight += static_cast<float>(scale * other.weight);
    first += (scale * other.first).cast<float>();
    for (std::size_t i = 0; i < 6; ++i) second[i] += static_cast<float>(scale * other.second.e[i]);
  }
  Moments unpacked() const {
    Moments m{static_cast<double>(weight), first.cast<double>(), {}};
    for (std::size_t i = 0; i < 6; ++i) m.second.e[i] = static_cast<double>(second[i]);
    return m;
  }
};

inline void Moments::add(const Moments& other, double scale, const Eigen::Vector3d& shift_m) {
  const double w = scale * other.weight;
  const Eigen::Vector3d f = scale * other.first;
  const Eigen::Vector3d g = f + w * shift_m;  // our first moment of other's points
  weight += w;
  first += g;
  const Eigen::Vector3d& s = shift_m;
  const auto& m = other.second.e;
  // sum w (q + s)(q + s)^T = M + f s^T + s f^T + w s s^T, and f s^T + w s s^T = g s^T.
  second.e[0] += scale * m[0] + g.x() * s.x() + s.x() * f.x();
  second.e[1] += scale * m[1] + g.x() * s.y() + s.x() * f.y();
  second.e[2] += scale * m[2] + g.x() * s.z() + s.x() * f.z();
  second.e[3] += scale * m[3] + g.y() * s.y() + s.y() * f.y();
  second.e[4] += scale * m[4] + g.y() * s.z() + s.y() * f.z();
  second.e[5] += scale * m[5] + g.z() * s.z() + s.z() * f.z();
}

inline Eigen::Matrix3d Moments::covariance() const {
  const Eigen::Vector3d m = mean();
  return second.matrix() / weight - m * m.transpose();
}

}  // namespace planemap

#include "planemap/membership.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planemap {

double expected_scatter_m2(double centre_m, double cell_size_m, double variance_m2) {
  const double sigma_m = std::sqrt(variance_m2);
  const double low = (std::abs(centre_m) - 0.5 * cell_size_m) / sigma_m;
  const double high = (std::abs(centre_m) + 0.5 * cell_size_m) / sigma_m;
  constexpr double kFar = 3.0;
  if (sigma_m < kLayeredShare * cell_size_m || std::abs(low) > kFar) return variance_m2;
  const auto density = [](double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi); };
  const auto above = [](double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); };
  const double share = above(low) - above(high);
  return variance_m2 * (1.0 + (low * density(low) - high * density(high)) / share);
}

bool is_layered(double variance_m2, double cell_size_m) {
  const double noisy_m = 0.5 * kLayeredShare * cell_size_m;
  return !(variance_m2 < noisy_m * noisy_m);
}

bool lies_aside(const Cell& cell, const Eigen::Vector3d& centre_m, const Plane& plane, double cell_size_m) {
  constexpr double kOffset_m = 0.005;  // that a real sensor bends within a hand's breadth
  constexpr double kSigmas = 3.0;
  if (!cell.has_evidence()) return false;
  const double variance_m2 = cell.evidence_variance_m2();
  if (is_layered(variance_m2, cell_size_m)) return false;
  const double offset_m = std::abs(plane.signed_distance_m(centre_m + cell.evidence.unpacked().mean()));
  return offset_m > kOffset_m + kSigmas * std::sqrt(variance_m2 / static_cast<double>(cell.evidence_count));
}

}  // namespace planemap

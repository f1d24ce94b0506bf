#include "planemap/cell_normals.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "planemap/membership.hpp"

namespace planemap {

double min_max_deviation_rad(std::span<const UncertainCentre> centres, const Eigen::Vector3d& normal,
                             const Eigen::Vector3d& tangent_1, const Eigen::Vector3d& tangent_2) {
  double moved_1 = 0.0;
  double moved_2 = 0.0;
  double spread_1 = 0.0;
  double spread_2 = 0.0;
  for (const UncertainCentre& centre : centres) {
    const double sigma = std::sqrt(normal.cwiseAbs2().dot(centre.variance_m2));
    const double t1 = tangent_1.dot(centre.offset_m);
    const double t2 = tangent_2.dot(centre.offset_m);
    moved_1 += std::abs(t1) * sigma;
    moved_2 += std::abs(t2) * sigma;
    spread_1 += t1 * t1;
    spread_2 += t2 * t2;
  }
  if (!(spread_1 > 0.0 && spread_2 > 0.0)) return std::numeric_limits<double>::infinity();
  return std::atan(std::max(moved_1 / spread_1, moved_2 / spread_2));
}

void NormalEstimator::gather(const UncertainGrid& grid, CellRef ref, std::span<const CellRef> around) {
  neighbourhood_.clear();
  const auto take = [&](CellRef other) {
    if (grid.cell(other).sums.count > 0.0) neighbourhood_.push_back(other);
  };
  if (config_.neighbourhood_depth == 1 && !around.empty()) {
    std::for_each(around.begin(), around.end(), take);
  } else {
    grid.for_each_neighbour(ref, config_.neighbourhood_depth, take);
  }
}

std::optional<NormalEstimator::Fit> NormalEstimator::fit_gathered(const UncertainGrid& grid, CellRef ref) const {
  const Eigen::Vector3d origin = grid.geometric_centre_m(ref);
  const bool pooled = config_.fit == NormalFit::kPooled;
  Moments sum;
  double count = 0.0;
  for (const CellRef other : neighbourhood_) {
    const Cell& cell = grid.cell(other);
    const Eigen::Vector3d shift = grid.geometric_centre_m(other) - origin;
    if (pooled) {
      sum.add(cell.evidence.unpacked(), 1.0, shift);
      count += cell.sums.count;
    } else {
      const Eigen::Vector3d centre = cell.sums.mean_m() + shift;
      sum.add(Moments{1.0, centre, Symmetric3::outer(centre)});
    }
  }
  if (!(sum.weight > 0.0)) return std::nullopt;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(sum.covariance());
  if (!(solver.eigenvalues()(1) > 1e-12)) return std::nullopt;  // a point or a line spans no plane
  Fit fit{sum.mean(),
          solver.eigenvectors().col(0),
          solver.eigenvectors().col(1),
          solver.eigenvectors().col(2),
          solver.eigenvalues()(1),
          std::max(solver.eigenvalues()(0), 0.0),
          0.0};
  if (fit.normal.dot(grid.cell(ref).sums.view.cast<double>()) < 0.0) fit.normal = -fit.normal;
  fit.expected_variance_m2 = count / sum.weight;  // the weights are 1 / sigma^2
  return fit;
}

bool NormalEstimator::drop_other_side(const UncertainGrid& grid, CellRef ref, const Eigen::Vector3d& normal) {
  const auto other_side = [&](CellRef other) {
    return other != ref && normal.dot(grid.cell(other).sums.view.cast<double>()) < 0.0;
  };
  const auto end = std::remove_if(neighbourhood_.begin(), neighbourhood_.end(), other_side);
  const bool dropped = end != neighbourhood_.end();
  neighbourhood_.erase(end, neighbourhood_.end());
  return dropped;
}

bool NormalEstimator::is_flat(const Fit& fit) const {
  if (config_.flatness_sigmas <= 0.0) return true;
  return fit.variance_m2 <= allowed_variance_m2(fit.expected_variance_m2);
}

double NormalEstimator::allowed_variance_m2(double expected_m2) const {
  return config_.flatness_sigmas * config_.flatness_sigmas * expected_m2 +
         config_.flatness_floor_m * config_.flatness_floor_m;
}

std::optional<NormalEstimator::Fit> NormalEstimator::fit_own_surface(const UncertainGrid& grid, CellRef ref,
                                                                     std::span<const CellRef> around) {
  neighbourhood_.assign(1, ref);
  std::optional<Fit> own = fit_gathered(grid, ref);
  // The own points must span a patch: a strip along an edge turns freely about it.
  const double least_spread_m = kLeastPatchSpread * grid.cell_size_m();
  if (!own || !is_flat(*own) || own->spread_1_m2 < least_spread_m * least_spread_m) return std::nullopt;
  const Eigen::Vector3d origin = grid.geometric_centre_m(ref);
  gather(grid, ref, around);
  const auto elsewhere = [&](CellRef other) {
    const Cell& cell = grid.cell(other);
    if (!cell.has_evidence()) return true;
    const Eigen::Vector3d shift = grid.geometric_centre_m(other) - origin;
    const double d_m = own->normal.dot(shift - own->centroid_m);
    return cell.evidence.unpacked().mean_square_distance(own->normal, d_m) >
               allowed_variance_m2(cell.evidence_variance_m2()) ||
           own->normal.dot(cell.sums.view.cast<double>()) < 0.0;
  };
  neighbourhood_.erase(std::remove_if(neighbourhood_.begin(), neighbourhood_.end(), elsewhere), neighbourhood_.end());
  std::optional<Fit> together = fit_gathered(grid, ref);
  if (together && is_flat(*together)) return together;
  neighbourhood_.assign(1, ref);
  return own;
}

double NormalEstimator::deviation_rad(const UncertainGrid& grid, CellRef ref, const Fit& fit) {
  if (neighbourhood_.size() < 4) {
    // Too few centres to perturb: what the points' own errors make of the tilt.
    double points = 0.0;
    for (const CellRef other : neighbourhood_) points += grid.cell(other).sums.count;
    return std::atan(std::sqrt(fit.expected_variance_m2 / (points * fit.spread_1_m2)));
  }
  const Eigen::Vector3d origin = grid.geometric_centre_m(ref);
  centres_.clear();
  for (const CellRef other : neighbourhood_) {
    const CellSums& sums = grid.cell(other).sums;
    const double n = sums.count;
    const double share = config_.centre_error == CentreError::kMean ? 1.0 / (n * n) : 1.0 / n;
    centres_.push_back({sums.mean_m() + grid.geometric_centre_m(other) - origin - fit.centroid_m,
                        sums.error_m2.cast<double>() * share});
  }
  return min_max_deviation_rad(centres_, fit.normal, fit.tangent_1, fit.tangent_2);
}

std::optional<UncertainNormal> NormalEstimator::fit(const UncertainGrid& grid, CellRef ref,
                                                    std::span<const CellRef> around) {
  gather(grid, ref, around);
  std::optional<Fit> fit = fit_gathered(grid, ref);
  if (fit && config_.view_side && drop_other_side(grid, ref, fit->normal)) fit = fit_gathered(grid, ref);
  // Beside an edge the neighbourhood holds two surfaces, and the cell may still lie on one of them.
  if (fit && !is_flat(*fit)) fit = fit_own_surface(grid, ref, around);
  if (!fit) return std::nullopt;
  return UncertainNormal{fit->normal, deviation_rad(grid, ref, *fit)};
}

void NormalEstimator::refresh(UncertainGrid& grid, CellRef ref, std::span<const CellRef> around) {
  const Cell& cell = grid.cell(ref);
  const double count = cell.sums.count;
  if (cell.normal_count > 0.0F && count < cell.normal_count * (1.0 + config_.refresh_growth)) return;
  const std::optional<UncertainNormal> fitted = fit(grid, ref, around);
  Cell& changed = grid.writable(ref);
  changed.normal_count = static_cast<float>(count);
  changed.normal = fitted ? Eigen::Vector3f(fitted->normal.cast<float>()) : Eigen::Vector3f::Zero();
  changed.deviation_rad = fitted ? static_cast<float>(fitted->deviation_rad) : 0.0F;
}

}  // namespace planemap

#pragma once

#include <Eigen/Core>
#include <optional>
#include <planemap/config.hpp>
#include <planemap/uncertain_grid.hpp>
#include <span>
#include <vector>

namespace planemap {

/// A virtual centre as the min-max approach perturbs it.
struct UncertainCentre {
  Eigen::Vector3d offset_m;     ///< from the centroid of the neighbourhood
  Eigen::Vector3d variance_m2;  ///< squared standard errors along the world's axes
};

/// Deviation of the normal of a plane fitted to uncertain centres, radians; Definition 3, the min-max approach.
///
/// Each centre is moved along the normal by its standard error, to the side that turns the plane most: in proportion to
/// its place along a tangent t, with alternating signs about the plane's centre (Fig. 2a). To first order the plane
/// then tilts by sum |t.q_i| sigma_i / sum (t.q_i)^2; the greatest over the two principal tangents is returned.
/// Infinite where the centres don't span a plane.
double min_max_deviation_rad(std::span<const UncertainCentre> centres, const Eigen::Vector3d& normal,
                             const Eigen::Vector3d& tangent_1, const Eigen::Vector3d& tangent_2);

/// An uncertain normal vector (Definition 3).
struct UncertainNormal {
  Eigen::Vector3d normal;  ///< unit, towards the side from which the cell was seen
  double deviation_rad;
};

/// Fits normals of cells to their neighbourhoods (Definitions 2 and 3).
class NormalEstimator {
 public:
  explicit NormalEstimator(const NormalConfig& config) : config_(config) {}

  /// The uncertain normal of a cell; empty where its neighbourhood spans no plane or is not flat.
  std::optional<UncertainNormal> fit(const UncertainGrid& grid, CellRef ref) { return fit(grid, ref, {}); }

  /// Fits the normal anew where the cell gained enough points since the last time.
  /// @param around  the cells at most one step away, if somebody has looked already
  void refresh(UncertainGrid& grid, CellRef ref, std::span<const CellRef> around = {});

 private:
  struct Fit {
    Eigen::Vector3d centroid_m;  ///< from the cell's geometric centre
    Eigen::Vector3d normal;
    Eigen::Vector3d tangent_1;
    Eigen::Vector3d tangent_2;
    double spread_1_m2;  ///< variance of the evidence along tangent_1, the lesser one
    double variance_m2;  ///< of the evidence about the plane
    double expected_variance_m2;
  };

  std::optional<UncertainNormal> fit(const UncertainGrid& grid, CellRef ref, std::span<const CellRef> around);
  void gather(const UncertainGrid& grid, CellRef ref, std::span<const CellRef> around);
  std::optional<Fit> fit_gathered(const UncertainGrid& grid, CellRef ref) const;
  std::optional<Fit> fit_own_surface(const UncertainGrid& grid, CellRef ref, std::span<const CellRef> around);
  bool is_flat(const Fit& fit) const;
  double allowed_variance_m2(double expected_m2) const;
  double deviation_rad(const UncertainGrid& grid, CellRef ref, const Fit& fit);
  bool drop_other_side(const UncertainGrid& grid, CellRef ref, const Eigen::Vector3d& normal);

  NormalConfig config_;
  std::vector<CellRef> neighbourhood_;  ///< kept to spare allocations; holds nothing between calls
  std::vector<UncertainCentre> centres_;
};

}  // namespace planemap

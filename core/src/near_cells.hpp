#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <planemap/config.hpp>
#include <planemap/uncertain_grid.hpp>
#include <vector>

#include "cell_table.hpp"
#include "simd/point_kernels.hpp"

namespace planemap {

/// The cells that the points of one scan lie in, and those around them that may win the points. Virtual centres are
/// read once, as they were before the scan.
class NearCells {
 public:
  explicit NearCells(const GridConfig& config) : config_(config) {}

  /// Forgets the last scan.
  /// @param base      the cell that the sensor is in; all places count from it
  /// @param origin_m  the sensor, world frame
  void begin(const CellIndex& base, const Eigen::Vector3d& origin_m);

  /// Fills in the run's cell and candidates. A cell that the grid does not have is made.
  /// @param cell  that the run's points lie in, from the base
  void find_candidates(UncertainGrid& grid, const CellIndex& cell, simd::Run& run);

  const simd::Candidate* candidates() const { return candidates_.data(); }
  /// By target, as the candidates name them.
  simd::Accumulator* accumulators() { return accumulators_.data(); }
  std::size_t size() const { return cells_.size(); }
  CellRef cell(std::size_t target) const { return cells_[target].ref; }
  const simd::Accumulator& accumulator(std::size_t target) const { return accumulators_[target]; }

 private:
  struct NearCell {
    CellRef ref;
    Eigen::Vector3d centre_cells;  ///< virtual centre from the cell's own geometric one
    double variance_cells2 = 0.0;  ///< S_s / n^2
    Eigen::Vector3f view;          ///< from where it was seen
    bool has_points = false;
    std::uint32_t first_candidate = 0;
    std::uint32_t candidate_count = 0;  ///< 0: not listed yet
  };
  /// A candidate for the cell at hand.
  struct Rival {
    Eigen::Vector3d place_cells;  ///< virtual centre from the geometric centre of the cell at hand
    double bias_cells2;           ///< Eq. 7 for a point in the middle of the cell at hand
    std::uint32_t target;
  };

  std::uint32_t number_of(const UncertainGrid& grid, CellRef ref, const CellIndex& cell);
  void list_candidates(UncertainGrid& grid, std::uint32_t number, const CellIndex& cell);
  void gather(const UncertainGrid& grid, std::uint32_t number, const CellIndex& cell);
  void drop_losers();

  GridConfig config_;
  CellIndex base_ = CellIndex::Zero();
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  CellTable table_;
  std::vector<NearCell> cells_;
  std::vector<simd::Accumulator> accumulators_;  ///< beside cells_
  std::vector<simd::Candidate> candidates_;
  std::vector<Rival> rivals_;
};

}  // namespace planemap

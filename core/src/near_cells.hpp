#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <planemap/config.hpp>
#include <planemap/uncertain_grid.hpp>
#include <vector>

#include "cell_table.hpp"
#include "divider.hpp"
#include "simd/point_kernels.hpp"

namespace planemap {

/// The cells that some points of one scan lie in, and those around them that may win the points. Virtual centres are
/// read once, as they were before the scan. The grid is only read meanwhile, so that two threads may do so.
class NearCells {
 public:
  explicit NearCells(const GridConfig& config) : config_(config) {}

  /// Forgets the last scan.
  /// @param base      the cell that the sensor is in; all places count from it
  /// @param T_world_sensor  the sensor's pose
  /// @param planes          of the cells' labels
  void begin(const CellIndex& base, const Eigen::Isometry3d& T_world_sensor, const DividingPlanes& planes);

  /// Fills in the run's cell and candidates. A cell that the grid does not have is noted.
  /// @param cell  that the run's points lie in, from the base
  void find_candidates(const UncertainGrid& grid, const CellIndex& cell, simd::Run& run);
  /// Makes the noted cells, unless somebody else has.
  void make_noted(UncertainGrid& grid);

  const simd::Candidate* candidates() const { return candidates_.data(); }
  bool has_dividers() const { return !dividers_.empty(); }
  const simd::Divider* dividers() const { return dividers_.data(); }
  /// By target, as the candidates name them.
  simd::Accumulator* accumulators() { return accumulators_.data(); }
  std::size_t size() const { return cells_.size(); }
  /// @pre make_noted() has been called
  CellRef cell(std::size_t target) const { return cells_[target].ref; }
  const simd::Accumulator& accumulator(std::size_t target) const { return accumulators_[target]; }

 private:
  struct NearCell {
    CellRef ref;                   ///< of a noted one, once it has been made
    Eigen::Vector3d centre_cells;  ///< virtual centre from the cell's own geometric one
    double variance_cells2 = 0.0;  ///< S_s / n^2
    Eigen::Vector3f view;          ///< from where it was seen
    bool has_points = false;
    std::uint32_t first_candidate = 0;
    std::uint32_t candidate_count = 0;  ///< 0: not listed yet
    std::uint32_t second = kNone;       ///< number of the other cell at its place
  };
  /// A cell that is to be made.
  struct Noted {
    std::uint32_t number;
    std::uint32_t first;  ///< number of the cell that it shares a place with; kNone: there is none
    CellIndex cell;       ///< from the base
  };
  /// A candidate for the cell at hand.
  struct Rival {
    Eigen::Vector3d place_cells;  ///< virtual centre from the geometric centre of the cell at hand
    double bias_cells2;           ///< Eq. 7 for a point in the middle of the cell at hand
    std::uint32_t target;
  };

  static constexpr std::uint32_t kNone = CellTable::kNone;

  std::uint32_t number_of(const UncertainGrid& grid, CellRef ref, const CellIndex& cell);
  std::uint32_t add(const CellIndex& cell);
  std::uint32_t add(const UncertainGrid& grid, CellRef ref, const CellIndex& cell);
  std::uint32_t note(const CellIndex& cell, std::uint32_t first);
  void pair(std::uint32_t number, const Plane* plane, std::uint32_t other, const Plane* other_plane);
  void list_candidates(const UncertainGrid& grid, std::uint32_t number, const CellIndex& cell);
  void gather(const UncertainGrid& grid, std::uint32_t number, const CellIndex& cell);
  void open_second(const UncertainGrid& grid, std::uint32_t number, const CellIndex& cell, const Eigen::Vector3f& view);
  void drop_losers();

  GridConfig config_;
  ScanFrame frame_{};
  DividingPlanes planes_;
  CellTable table_;
  std::vector<NearCell> cells_;
  std::vector<Noted> noted_;
  std::vector<simd::Accumulator> accumulators_;  ///< beside cells_
  std::vector<simd::Candidate> candidates_;
  std::vector<simd::Divider> dividers_;  ///< as the accumulators name them
  std::vector<Rival> rivals_;
};

}  // namespace planemap

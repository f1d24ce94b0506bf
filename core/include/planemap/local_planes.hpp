#pragma once

#include <planemap/assignment.hpp>
#include <planemap/config.hpp>
#include <planemap/plane_statistics.hpp>
#include <planemap/uncertain_grid.hpp>
#include <span>
#include <utility>
#include <vector>

namespace planemap {

/// Cells of one scan that form a plane.
struct LocalPlane {
  PlaneStatistics statistics;
  PlaneFit fit;
  std::vector<CellRef> cells;
};

/// Grows local planes over the dense cells of one scan (paper, section IV.B.1; Fig. 3, line 5).
class LocalPlaneExtractor {
 public:
  LocalPlaneExtractor(const GridConfig& grid, const NormalConfig& normals, const PlaneConfig& planes);

  /// The local planes of the cells that the scan touched. @pre the cells' `working` is their place in `changes`
  std::vector<LocalPlane> extract(const UncertainGrid& grid, std::span<const CellChange> changes);

 private:
  bool eligible(const Cell& cell) const;
  std::vector<std::uint32_t> seeds(const UncertainGrid& grid, std::span<const CellChange> changes) const;
  LocalPlane start(const UncertainGrid& grid, CellRef first);
  static void take(const UncertainGrid& grid, CellRef ref, LocalPlane& plane);
  /// Takes in what is similar and reached from the plane's cells.
  /// @param from    first of its cells that has not been looked around
  /// @param number  of the plane, which then leaves out what lies aside of it and notes that; nullptr: takes that, too
  void grow(const UncertainGrid& grid, LocalPlane& plane, std::size_t from, const std::size_t* number);
  void release_small(const UncertainGrid& grid, LocalPlane& plane);
  void take_aside(const UncertainGrid& grid, CellRef ref, LocalPlane& plane);
  bool similar(const UncertainGrid& grid, CellRef ref, const PlaneFit& plane) const;

  GridConfig grid_config_;
  NormalConfig normal_config_;
  PlaneConfig config_;
  double squared_chord_;
  std::vector<std::uint32_t> visited_;                  ///< per changed cell: who looked at it last
  std::vector<std::pair<std::size_t, CellRef>> aside_;  ///< number of a plane, and a cell that lies aside of it
  std::uint32_t visitor_ = 0;  ///< number of the plane that is growing, from 1; kTaken: in a plane
  static constexpr std::uint32_t kTaken = 0xffffffff;
};

}  // namespace planemap

#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <planemap/plane_map.hpp>
#include <planemap/snapshot.hpp>
#include <planemap/uncertain_grid.hpp>
#include <span>
#include <unordered_map>
#include <vector>

namespace planemap {

/// A cell's points seen from another frame.
/// @param cell         with points, taken relative to centre_m
/// @param centre_m     geometric centre of the cell in its own grid
/// @param T            from its frame to the other one
/// @param to_centre_m  geometric centre of the cell in the other grid that takes the points
/// Sums and evidence are those of the moved points but for the second moments of the plain sums, of which a cell keeps
/// the diagonal only: their shape is taken from the evidence.
Cell moved(const Cell& cell, const Eigen::Vector3d& centre_m, const Eigen::Isometry3d& T,
           const Eigen::Vector3d& to_centre_m);

/// Adds the cells of another map to a grid, and hands them to the steps of the method a scan's worth at a time.
class MapAddition {
 public:
  /// @param other           a whole map with cells of the grid's size; must outlive this
  /// @param T_ours_theirs   from its frame to the grid's; empty: they are the same, and sums add without rounding twice
  MapAddition(const MapSnapshot& other, const std::optional<Eigen::Isometry3d>& T_ours_theirs);

  /// Adds the points of all cells. Cells keep their planes.
  void add_cells(UncertainGrid& grid, PlaneMap& planes);

  /// Batches of cells that got points, neighbours mostly in one batch: all cells twice, the second time cut elsewhere,
  /// so that what was at the rim of a batch is inside of one.
  std::size_t batch_count() const { return cells_.empty() ? 0 : 2 * whole_batches() + 1; }
  /// Fills `changes` with the cells of a batch, and makes them working ones.
  void begin_batch(std::size_t batch, UncertainGrid& grid, std::vector<CellChange>& changes) const;
  /// What stands for the scan that saw the cells of a batch: where they were seen from, about, and when.
  ScanPose pose_of(const UncertainGrid& grid, std::span<const CellChange> changes) const;

  /// Tells our planes when theirs were seen first.
  void note_times(const UncertainGrid& grid, PlaneMap& planes) const;

 private:
  struct Added {
    CellRef ours;
    PlaneSlot theirs;  ///< plane of their cell
    bool operator<(const Added& other) const { return ours < other.ours; }
  };
  std::size_t whole_batches() const;
  void add_cell(UncertainGrid& grid, PlaneMap& planes, const Block& block, std::size_t ordinal);

  const MapSnapshot& other_;
  std::optional<Eigen::Isometry3d> T_;
  std::unordered_map<PlaneId, const PlaneRecord*> records_;
  std::vector<Added> added_;    ///< by our cell
  std::vector<CellRef> cells_;  ///< ours, each once
};

}  // namespace planemap

#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <planemap/cell.hpp>
#include <planemap/config.hpp>
#include <planemap/scan.hpp>
#include <planemap/uncertain_grid.hpp>
#include <vector>

namespace planemap {

/// What one scan adds to one cell; it has not been added yet.
struct CellChange {
  CellRef cell;
  CellSums added;  ///< about the cell's geometric centre
};

/// Assigns the points of a scan to cells by expected squared distance (Eq. 7; Fig. 3, line 2).
///
/// The virtual centres are frozen for the length of a scan, so the order of its points does not matter: the cells'
/// regions are then a power diagram. A point's candidates are the cell it lies in and the 26 around it that have
/// points; where the own cell has none it is made and takes the point, for otherwise the grid would never grow.
class Assigner {
 public:
  Assigner(const SensorConfig& sensor, const GridConfig& grid) : sensor_(sensor), config_(grid) {}

  /// Assigns the scan. The grid gains empty cells but no evidence: that is in changes(), in the order of first touch,
  /// and each changed cell's `working` is its place there until finish().
  PointCounts assign(UncertainGrid& grid, const Scan& scan, const Eigen::Isometry3d& T_world_sensor);
  const std::vector<CellChange>& changes() const { return changes_; }
  /// Ends the scan: no cell is working any more. changes() stay until the next scan.
  void finish(UncertainGrid& grid);

 private:
  /// A virtual centre that may win points of an own cell; metres from the own cell's geometric centre.
  struct Candidate {
    double x, y, z;
    double bias;  ///< S_s / n^2, square metres
    CellRef cell;
  };
  /// A part of candidates_.
  struct Range {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  /// Candidates of the points that lie in one cell, and of those in each eighth of it; these are listed when a point
  /// comes.
  struct OwnCell {
    Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
    Range all;
    std::array<Range, 8> eighths;
  };
  /// Neighbouring points that go to the same cell, summed up before they are handed over.
  struct Run {
    std::uint32_t own = 0;
    CellRef cell;
    double n = 0.0;
    Eigen::Vector3d first_m;
    Symmetric3 second_m2;
    Eigen::Vector3d variance_sensor_m2;
  };

  template <class ScanType>
  PointCounts assign_points(UncertainGrid& grid, const ScanType& scan, const Eigen::Isometry3d& T_world_sensor);
  std::uint32_t own_cell(UncertainGrid& grid, const CellIndex& index, const Eigen::Vector3d& origin_m);
  void list_candidates(const UncertainGrid& grid, OwnCell& own, CellRef ref, const Eigen::Vector3d& origin_m);
  void list_eighth(OwnCell& own, std::uint32_t eighth, double quarter_edge_m);
  Range without_losers(Range range, const Eigen::Vector3d& middle_m, double half_edge_m);
  const Candidate& nearest(Range range, const Eigen::Vector3d& q_m) const;
  std::uint32_t working(UncertainGrid& grid, CellRef ref);
  void flush(UncertainGrid& grid, const Run& run);

  SensorConfig sensor_;
  GridConfig config_;
  Eigen::Matrix3d R_squared_ = Eigen::Matrix3d::Identity();
  std::vector<CellChange> changes_;
  std::vector<std::int32_t> own_of_change_;  ///< place in own_ of each changed cell; -1: no point lies in it
  std::vector<OwnCell> own_;
  std::vector<Candidate> candidates_;
};

}  // namespace planemap

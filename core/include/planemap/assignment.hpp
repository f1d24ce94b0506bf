#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <memory>
#include <planemap/cell.hpp>
#include <planemap/config.hpp>
#include <planemap/plane.hpp>
#include <planemap/scan.hpp>
#include <planemap/second_thread.hpp>
#include <planemap/uncertain_grid.hpp>
#include <vector>

namespace planemap {

/// The planes that tell the points of two cells at one place apart.
struct DividingPlanes {
  /// The plane of a label; nullptr: none that is known well enough.
  std::function<const Plane*(PlaneSlot)> of = [](PlaneSlot) { return nullptr; };
  double pose_variance_m2 = 0.0;  ///< of a point's distance to its plane, by the error of the scan's pose
};

/// What one scan adds to one cell; it has not been added yet.
struct CellChange {
  CellRef cell;
  ScanSums added;
  double trust = 1.0;  ///< that it deserves as evidence, 0 to 1; set by who adds it
};

/// Assigns the points of a scan to cells by expected squared distance (Eq. 7; Fig. 3, line 2).
///
/// The virtual centres are frozen for the length of a scan, so the order of its points does not matter: the cells'
/// regions are then a power diagram. A point's candidates are the cell it lies in and the 26 around it that have
/// points; where the own cell has none it is made and takes the point, for otherwise the grid would never grow.
///
/// A row of the scan is projected into cells, cut into runs of neighbours that lie in one cell, and each run's points
/// go to that cell's candidates, vectors of points at a time.
class Assigner {
 public:
  /// Throws std::invalid_argument where this machine does not have the instruction set of core.simd.
  /// @param second  assigns half of the points; not owned. nullptr: the caller's thread assigns all; the same comes out
  Assigner(const CoreConfig& core, const SensorConfig& sensor, const GridConfig& grid, SecondThread* second = nullptr);
  ~Assigner();
  Assigner(const Assigner&) = delete;
  Assigner& operator=(const Assigner&) = delete;

  /// Assigns the scan. The grid gains empty cells but no evidence: that is in changes(), in an order that depends on
  /// the scan and the grid alone, and each changed cell's `working` is its place there until finish().
  PointCounts assign(UncertainGrid& grid, const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                     const DividingPlanes& planes = {});
  std::vector<CellChange>& changes() { return changes_; }
  const std::vector<CellChange>& changes() const { return changes_; }
  /// Ends the scan: no cell is working any more. changes() stay until the next scan.
  void finish(UncertainGrid& grid);

 private:
  class Pass;

  std::unique_ptr<Pass> pass_;
  std::vector<CellChange> changes_;
};

}  // namespace planemap

#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <planemap/assignment.hpp>
#include <planemap/config.hpp>
#include <planemap/range_tiles.hpp>
#include <planemap/scan.hpp>
#include <planemap/uncertain_grid.hpp>
#include <span>
#include <vector>

namespace planemap {

/// Finds the cells of things that have gone: later scans see through them.
///
/// The inverse of ray casting: each stored cell within a scan's view is projected into the scan, as wavemap does with
/// its blocks (Reijgwart et al., RSS 2023), so a scan costs by the cells in view, not by its rays. A cell is seen
/// through when every ray that passes through its cube, made larger by the clearance, goes on behind it by more than
/// the errors of the two depths. A surface in the cell stops at least one of these rays wherever it is looked at from,
/// so neither grazing rays nor those past an edge count against it.
///
/// How long a cell has been seen through adds up over the scans, and starts anew when the cell gets points.
class Wear {
 public:
  /// @param cell_size_m  edge of a cell
  Wear(const WearConfig& config, const SensorConfig& sensor, double cell_size_m);

  /// Looks at the cells in the scan's view. Only reads the grid.
  /// @param changes  the cells that got points from the scan, which are still working ones
  /// @return the cells with points that have been seen through for long enough; valid until the next call. Take their
  /// points away: they are counted from zero again.
  std::span<const CellRef> look(const UncertainGrid& grid, const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                                std::span<const CellChange> changes);

 private:
  /// For how long each cell was seen through, by place, in parts of the time after which it goes.
  using Page = std::array<std::uint8_t, kBlockCells>;

  /// What blocks can be seen: those in a box of the grid and between four planes through the sensor.
  struct View {
    Eigen::Isometry3d T_sensor_world;
    Eigen::Vector3i first_block;
    Eigen::Vector3i blocks;  ///< of the box, along each axis
    double range_m;
    std::array<Eigen::Vector3d, 4> sides;  ///< unit normals, outwards, sensor frame
  };

  std::uint32_t elapsed_parts(std::int64_t utime);
  View view_of(const Eigen::Isometry3d& T_world_sensor) const;
  bool in_view(const View& view, const BlockIndex& index) const;
  void look_at(const UncertainGrid& grid, std::uint32_t slot, const View& view, std::uint32_t credit);
  bool is_before_surface(const Eigen::Vector3f& p_sensor_m) const;
  Eigen::AlignedBox2i outline(const Eigen::Vector3f& p_sensor_m, const Eigen::Matrix3f& axes, float half_m) const;
  bool is_behind(float nearest_m, float depth_m, float cell_variance_m2) const;
  bool is_seen_through(const Cell& cell, const Eigen::Vector3f& p_sensor_m, const Eigen::Matrix3f& axes) const;
  std::uint8_t& seen_through(std::uint32_t slot, int place);
  void forget(const UncertainGrid& grid, CellRef ref);

  WearConfig config_;
  SensorConfig sensor_;
  double cell_size_m_;
  float half_m_;                        ///< half the edge of a cell's cube with its clearance
  std::int64_t part_us_;                ///< what a cell's time is counted in
  std::uint32_t longest_look_;          ///< for which one look counts at most, in parts
  float depth_factor_ = 0.0F;           ///< sigma_z / z^2 of the scan, 1/m
  RangeTiles tiles_;                    ///< of the scan
  std::int64_t utime_ = 0;              ///< up to which time has been counted, microseconds; 0: no scan yet
  std::uint32_t scans_ = 0;             ///< which share of a large view is looked at; wraps
  std::vector<CellRef> found_;          ///< in this scan
  std::vector<std::uint32_t> page_of_;  ///< by block slot, from 1; 0: nothing of the block was seen through yet
  std::vector<Page> pages_;
};

}  // namespace planemap

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <planemap/assignment.hpp>
#include <planemap/config.hpp>
#include <planemap/neighbourhoods.hpp>
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
  std::span<const CellRef> cells;  ///< held by the extractor, until its next scan
};

/// Grows local planes over the dense cells of one scan (paper, section IV.B.1; Fig. 3, line 5).
class LocalPlaneExtractor {
 public:
  LocalPlaneExtractor(const GridConfig& grid, const NormalConfig& normals, const PlaneConfig& planes);

  /// The local planes of the cells that the scan touched; valid until the next call.
  /// @pre the cells' `working` is their place in `changes`
  std::span<const LocalPlane> extract(const UncertainGrid& grid, std::span<const CellChange> changes,
                                      const Neighbourhoods& neighbourhoods);

 private:
  static constexpr std::uint32_t kTaken = 0xffffffff;
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// What growing asks of a changed cell, side by side for all of them.
  struct Candidate {
    Eigen::Vector3d normal;
    Eigen::Vector3d middle_m;
    double deviation_rad;
    std::uint32_t first_neighbour;  ///< in neighbours_
    std::uint32_t last_neighbour;
    std::uint32_t visitor;  ///< who looked at it last; kTaken: it is in a plane, or can't be in one
    std::uint32_t next;     ///< the next cell of its plane, a change; kNone: it is the last
  };
  /// A plane that grows: its cells are a list from candidate to candidate, so that any number of planes may grow in
  /// turn.
  struct Growing {
    PlaneStatistics statistics;
    PlaneFit fit;
    std::uint32_t first = kNone;
    std::uint32_t last = kNone;
    std::size_t size = 0;
  };

  bool eligible(const Cell& cell) const;
  void list_candidates(const UncertainGrid& grid, std::span<const CellChange> changes,
                       const Neighbourhoods& neighbourhoods);
  void sort_seeds();
  void grow_all(const UncertainGrid& grid, std::span<const CellChange> changes, bool strict);
  /// @return number of a new plane, of one cell
  std::size_t start(const UncertainGrid& grid, std::span<const CellChange> changes, std::uint32_t change);
  /// Takes in what is similar and reached from the plane's cells.
  /// @param from    first of its cells that has not been looked around
  /// @param strict  leaves out what lies aside of the plane, and notes that; else it takes that, too
  void grow(const UncertainGrid& grid, std::span<const CellChange> changes, std::size_t number, std::uint32_t from,
            bool strict);
  void take(const UncertainGrid& grid, CellRef ref, std::uint32_t change, Growing& plane);
  void release_small(Growing& plane);
  void take_aside(const UncertainGrid& grid, std::span<const CellChange> changes, std::uint32_t change,
                  std::size_t number);
  bool similar(const Candidate& cell, const PlaneFit& plane) const;
  void list_planes(std::span<const CellChange> changes);

  GridConfig grid_config_;
  NormalConfig normal_config_;
  PlaneConfig config_;
  double squared_chord_;

  // Of the scan at hand; kept to spare allocations.
  std::vector<Candidate> candidates_;      ///< by change
  std::vector<std::uint32_t> neighbours_;  ///< changes that can be in planes, of one candidate after another
  std::vector<std::uint32_t> seeds_;       ///< Fig. 3, line 4: the dense cells, by change
  std::vector<Growing> growing_;
  std::vector<std::pair<std::size_t, std::uint32_t>> aside_;  ///< number of a plane, and a change that lies aside of it
  std::vector<LocalPlane> planes_;
  std::vector<CellRef> cells_;  ///< of one plane after another
  std::uint32_t visitor_ = 0;   ///< number of the plane that is growing, from 1
};

}  // namespace planemap

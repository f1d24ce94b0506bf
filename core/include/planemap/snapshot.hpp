#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <planemap/block_table.hpp>
#include <planemap/plane.hpp>
#include <planemap/plane_state.hpp>
#include <span>
#include <vector>

namespace planemap {

class Block;
struct Cell;

/// A dense cell as readers see it.
struct CellView {
  Eigen::Vector3d centre_m;               ///< the virtual centre, world frame
  Eigen::Vector3d sigma_m;                ///< the centre's standard errors along the world's axes
  std::optional<Eigen::Vector3d> normal;  ///< unit, towards the side from which the cell was seen; empty: not known
  double deviation_rad = 0.0;             ///< of the normal (Definition 3)
  std::uint64_t count = 0;                ///< points
  PlaneId plane_id = kNoPlane;
  Eigen::Vector3i index = Eigen::Vector3i::Zero();  ///< whole-numbered place in the grid, which centre_m may be outside
};

/// What changed between two revisions of one epoch.
struct MapDelta {
  std::uint64_t epoch = 0;
  std::uint64_t since_revision = 0;
  std::uint64_t revision = 0;
  std::int64_t utime = 0;                                   ///< microseconds, of the newest mapped scan
  std::vector<std::shared_ptr<const PlaneRecord>> changed;  ///< new and changed planes, by id
  std::vector<RemovedPlane> removed;                        ///< by revision, then id
};

/// The map at one revision. Immutable: any number of threads may read it while the mapper goes on.
class MapSnapshot {
 public:
  /// What a snapshot is made of; the mapper fills it.
  struct Parts {
    std::uint64_t epoch = 0;
    std::uint64_t revision = 0;
    std::int64_t utime = 0;
    double cell_size_m = 0.0;
    int density_threshold = 0;
    std::size_t cell_count = 0;
    std::uint64_t removed_complete_since = 0;
    std::vector<std::shared_ptr<const PlaneRecord>> planes;
    std::vector<RemovedPlane> removed;
    BlockTable blocks;
    MapperState state;
  };
  MapSnapshot() = default;
  explicit MapSnapshot(Parts parts) : parts_(std::move(parts)) {}
  /// For the mapper, before anybody else has it.
  Parts& parts() { return parts_; }
  /// Lets go of blocks and planes; keeps its memory.
  void forget() {
    parts_.planes.clear();
    parts_.removed.clear();
    parts_.blocks.clear();
  }

  std::uint64_t epoch() const { return parts_.epoch; }
  std::uint64_t revision() const { return parts_.revision; }
  std::int64_t utime() const { return parts_.utime; }  ///< microseconds, of the newest mapped scan; 0: none yet
  double cell_size_m() const { return parts_.cell_size_m; }
  int density_threshold() const { return parts_.density_threshold; }  ///< a dense cell has more points
  std::size_t cell_count() const { return parts_.cell_count; }        ///< stored cells, dense or not
  std::size_t block_count() const { return parts_.blocks.size(); }

  /// All planes, by id.
  std::span<const std::shared_ptr<const PlaneRecord>> planes() const { return parts_.planes; }
  /// The plane of that name; nullptr: there is none (now).
  const PlaneRecord* find(PlaneId id) const;
  /// Planes that are no more, by revision, then id; the oldest of many are forgotten.
  std::span<const RemovedPlane> removed() const { return parts_.removed; }
  /// What changed since a revision of this epoch; empty where that is not known any more: take the whole map.
  std::optional<MapDelta> delta_since(std::uint64_t revision) const;
  /// The blocks of cells, in the order in which they were made.
  const BlockTable& blocks() const { return parts_.blocks; }
  /// What the mapper knew beside blocks and planes.
  const MapperState& state() const { return parts_.state; }
  /// Since which revision removed() names every plane that is no more.
  std::uint64_t removed_complete_since() const { return parts_.removed_complete_since; }
  bool is_dense(const Cell& cell) const;
  /// A cell of one of the blocks as readers see it. @pre the cell has points
  CellView view_of(const Block& block, std::size_t ordinal) const;
  /// Every dense cell, in an order that depends on the map alone.
  void for_each_cell(const std::function<void(const CellView&)>& visit) const;

 private:
  Parts parts_;
};

}  // namespace planemap

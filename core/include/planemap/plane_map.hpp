#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <planemap/config.hpp>
#include <planemap/local_planes.hpp>
#include <planemap/neighbourhoods.hpp>
#include <planemap/plane.hpp>
#include <planemap/plane_state.hpp>
#include <planemap/plane_statistics.hpp>
#include <planemap/pool.hpp>
#include <planemap/pose_evidence.hpp>
#include <planemap/uncertain_grid.hpp>
#include <span>
#include <unordered_map>
#include <vector>

namespace planemap {

/// Where planes are, in cubes of half the gap that is bridged: finds planes that are near each other without touching.
class CoarseIndex {
 public:
  explicit CoarseIndex(double edge_m) : inverse_edge_(1.0 / edge_m) {}

  void add(const Eigen::Vector3d& p_world_m, PlaneSlot plane) { change(p_world_m, plane, 1); }
  void remove(const Eigen::Vector3d& p_world_m, PlaneSlot plane) { change(p_world_m, plane, -1); }
  /// Adds to `found` the planes with cells at most `steps` cubes from the point's cube; may name a plane twice.
  void planes_near(const Eigen::Vector3d& p_world_m, int steps, std::vector<PlaneSlot>& found) const;
  /// Names the cube of a point; equal for points in one cube.
  std::uint64_t key_of(const Eigen::Vector3d& p_world_m) const;

 private:
  struct Entry {
    PlaneSlot plane;
    std::int32_t cells;
  };
  void change(const Eigen::Vector3d& p_world_m, PlaneSlot plane, std::int32_t by);
  Eigen::Vector3i cube_of(const Eigen::Vector3d& p_world_m) const;
  static std::uint64_t cube_key(const Eigen::Vector3i& cube);

  double inverse_edge_;
  std::unordered_map<std::uint64_t, std::vector<Entry>> cubes_;
};

/// What the global step did with one scan.
struct GlobalReport {
  std::size_t new_planes = 0;
  std::size_t merged_planes = 0;
  std::size_t removed_planes = 0;
};

/// The global planes (paper, section IV.B.2; Fig. 3, lines 6-9). Ids grow and are never used again; the order of all
/// steps depends on the scans alone, so equal inputs give equal maps.
class PlaneMap {
 public:
  PlaneMap(const GridConfig& grid, const PlaneConfig& planes, const PoseErrorConfig& pose_error);

  /// Takes a cell's evidence out of its plane, before the cell changes; attach() brings it back.
  void detach(const UncertainGrid& grid, CellRef ref);
  /// Takes the changed cell's evidence into its plane again, or lets go of a cell that has left its plane.
  void attach(UncertainGrid& grid, CellRef ref);

  /// Merges the local planes of a scan into the global ones: absorbed, merge, or new.
  GlobalReport merge(UncertainGrid& grid, std::span<const LocalPlane> local, std::span<const CellChange> changes,
                     const Neighbourhoods& neighbourhoods, const ScanPose& scan);

  /// Takes the points of cells away, and with them all that their planes had from them. A plane that was worn down to
  /// less than what starts one is gone.
  void wear_away(UncertainGrid& grid, std::span<const CellRef> cells);

  /// A plane was seen as early as that, by somebody else.
  void note_seen(PlaneSlot slot, std::int64_t first_seen_utime);

  /// What it knows beside its planes.
  MapperState state() const;
  /// Goes on with the planes of another one. @pre it has none yet; cells and records were checked (check_map)
  void restore(const UncertainGrid& grid, std::span<const std::shared_ptr<const PlaneRecord>> records,
               const MapperState& state);
  /// Records of the planes that changed since the last call, made anew; `records` holds all, by id.
  /// @return whether anything changed
  bool update_records(std::uint64_t revision, std::vector<std::shared_ptr<const PlaneRecord>>& records,
                      std::vector<RemovedPlane>& removed);
  /// Whether a plane changed since the last update_records().
  bool changed() const { return !dirty_.empty() || !removed_.empty(); }
  /// The plane that a cell is labelled with.
  const Plane& plane(PlaneSlot slot) const { return state(slot).fit.plane; }
  /// The same, if it is known well enough to tell points that are on it from others; nullptr: it is not, or no plane.
  const Plane* dividing_plane(PlaneSlot slot) const;
  double pose_variance_m2() const { return pose_variance_m2_; }
  /// The id of the plane that a cell is labelled with.
  static PlaneId id_of(PlaneSlot slot) { return slot; }

 private:
  struct State : PlaneState {
    explicit State(const Eigen::Vector3d& origin_m) { statistics = PlaneStatistics(origin_m); }
    explicit State(const PlaneState& kept) : PlaneState(kept) {}
    std::vector<CellRef> cells;  ///< also cells that have left; a cell's own label decides
    std::vector<PlaneId> merged;
    std::int64_t first_seen_utime = 0;
    std::int64_t last_seen_utime = 0;
    bool touched = false;  ///< by this scan
    bool dirty = false;    ///< since the last update_records()
  };

  State& state(PlaneSlot slot) { return *states_[slot]; }
  const State& state(PlaneSlot slot) const { return *states_[slot]; }
  void mark_changed(PlaneSlot slot);
  void refit(PlaneSlot slot);

  void join(UncertainGrid& grid, CellRef ref, PlaneSlot slot);
  void leave(UncertainGrid& grid, CellRef ref);
  void take(UncertainGrid& grid, CellRef ref, PlaneSlot slot);
  float member_weight(const UncertainGrid& grid, CellRef ref, const PlaneFit& fit) const;
  void forget_left_cells(const UncertainGrid& grid, PlaneSlot slot);
  void reweigh(UncertainGrid& grid, PlaneSlot slot);
  double band_m(const Cell& cell, const PlaneFit& fit) const;

  bool agree(const PlaneStatistics& a, const PlaneFit& fit_a, const PlaneStatistics& b, const PlaneFit& fit_b,
             double max_angle_rad, double max_offset_m) const;
  void merge_local(UncertainGrid& grid, const LocalPlane& local, const Neighbourhoods& neighbourhoods,
                   std::int64_t utime, GlobalReport& report);
  void begin_touching();
  void note_touching(const UncertainGrid& grid, std::span<const CellRef> cells);
  PlaneSlot absorb_into(UncertainGrid& grid, const LocalPlane& local, const Neighbourhoods& neighbourhoods,
                        GlobalReport& report);
  bool is_pure(const PlaneStatistics& statistics, const PlaneFit& fit) const;
  bool are_creased(const PlaneStatistics& a, const PlaneFit& fit_a, const PlaneStatistics& b,
                   const PlaneFit& fit_b) const;
  bool is_nearer(const UncertainGrid& grid, CellRef ref, const PlaneFit& a, const PlaneFit& b) const;
  /// The cells of a local plane that no plane has, or one that the local plane makes a crease with and is nearer than.
  /// @return valid until the next call
  std::span<const CellRef> free_cells(const UncertainGrid& grid, const LocalPlane& local);
  void start(UncertainGrid& grid, const LocalPlane& local, std::int64_t utime, GlobalReport& report);
  void settle(UncertainGrid& grid, PlaneSlot slot, GlobalReport& report);
  /// @return the plane that holds what slot held
  PlaneSlot merge_if_agreed(UncertainGrid& grid, PlaneSlot slot, PlaneSlot other, GlobalReport& report);
  PlaneSlot merge_planes(UncertainGrid& grid, PlaneSlot a, PlaneSlot b);
  void open_seconds(UncertainGrid& grid, std::span<const CellChange> changes);
  PlaneSlot plane_through(const UncertainGrid& grid, CellRef ref) const;
  bool is_sibling(const UncertainGrid& grid, CellRef ref, PlaneSlot slot) const;
  void adopt(UncertainGrid& grid, std::span<const CellChange> changes, const Neighbourhoods& neighbourhoods);
  PlaneSlot best_neighbour(const UncertainGrid& grid, CellRef ref, std::span<const CellRef> around) const;
  /// Of the planes beside a cell that are alike its own, the one that the cell's points are on while they are not on
  /// their own. kNoSlot: there is none.
  PlaneSlot better_neighbour(const UncertainGrid& grid, CellRef ref, std::span<const CellRef> around) const;
  void bridge(UncertainGrid& grid, std::span<const CellChange> changes, GlobalReport& report);
  PlaneSlot bridge_partner(const UncertainGrid& grid, std::span<const CellChange> changes, PlaneSlot slot);
  void dissolve_small(UncertainGrid& grid, GlobalReport& report);
  void dissolve(UncertainGrid& grid, PlaneSlot slot);
  bool is_worn_out(PlaneSlot slot) const;
  void take_pose(const ScanPose& scan);
  void write_record(PlaneSlot slot, std::uint64_t revision, PlaneRecord& record);

  GridConfig grid_config_;
  PlaneConfig config_;
  PoseErrorConfig pose_error_;
  bool poses_err_;            ///< as configured, or as a scan said of its own pose
  PoseCovariance last_pose_;  ///< covariance of the newest scan's pose
  double pose_variance_m2_;   ///< what a pose's error does to a point's distance to its plane: mean over the scans
  std::int64_t scans_ = 0;
  double max_angle_rad_;
  double alike_cosine_;  ///< of the angle up to which normals are similar
  double core_cosine_;
  std::vector<std::unique_ptr<State>> states_;  ///< by slot; slot 0 is no plane; empty: removed
  std::vector<PlaneSlot> born_;                 ///< of this scan
  std::vector<PlaneSlot> touched_;              ///< by this scan
  std::vector<PlaneSlot> dirty_;                ///< since the last update_records()
  std::vector<RemovedPlane> removed_;           ///< since the last update_records()
  CoarseIndex coarse_;
  Pool<PlaneRecord> record_pool_;
  Pool<PlaneState> state_pool_;

  // What steps of a scan need for themselves; kept to spare allocations.
  std::vector<PlaneSlot> touching_;      ///< each slot once
  std::vector<std::uint32_t> noted_in_;  ///< by slot: number of the search that noted it last
  std::uint32_t search_ = 0;
  std::vector<PlaneSlot> candidates_;
  std::vector<CellRef> free_;
  std::vector<CellRef> around_;
  std::vector<CellRef> others_;
  std::vector<std::uint64_t> cubes_;
  std::vector<PlaneSlot> near_;
};

}  // namespace planemap

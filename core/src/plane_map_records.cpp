// Records of the planes, for readers.

#include <algorithm>
#include <utility>

#include "planemap/plane_map.hpp"
#include "sort_unique.hpp"

namespace planemap {

void PlaneMap::write_record(PlaneSlot slot, std::uint64_t revision, PlaneRecord& record) {
  const State& plane = state(slot);
  record.id = id_of(slot);
  record.plane = plane.fit.plane;
  // The weight that the fit was made from: a plane whose core cells have all left stands as it was last fitted.
  Eigen::Matrix3d covariance = sensor_covariance(plane.fit, config_.offset_floor_m);
  if (poses_err_) {
    covariance += plane.pose_evidence.covariance(plane.fit, plane.statistics.origin_m(), last_pose_);
  }
  record.covariance = covariance_of(plane.fit, covariance);
  record.centroid_m = plane.fit.centroid_m;
  record.cell_count = static_cast<std::uint32_t>(plane.statistics.cell_count());
  record.point_count = static_cast<std::uint64_t>(plane.statistics.point_count());
  record.first_seen_utime = plane.first_seen_utime;
  record.last_seen_utime = plane.last_seen_utime;
  record.quality = plane.statistics.core_point_count() / std::max(plane.statistics.point_count(), 1.0);
  record.revision = revision;
  record.merged = plane.merged;
  record.state.reset();  // one that waits in the pool is taken again
  const std::shared_ptr<PlaneState> kept = state_pool_.take();
  *kept = plane;
  record.state = kept;
}

void PlaneMap::note_seen(PlaneSlot slot, std::int64_t first_seen_utime) {
  State& plane = state(slot);
  if (first_seen_utime >= plane.first_seen_utime) return;
  plane.first_seen_utime = first_seen_utime;
  if (!std::exchange(plane.dirty, true)) dirty_.push_back(slot);
}

MapperState PlaneMap::state() const {
  return {states_.size(), last_pose_, poses_err_, pose_variance_m2_, scans_};
}

void PlaneMap::restore(const UncertainGrid& grid, std::span<const std::shared_ptr<const PlaneRecord>> records,
                       const MapperState& state) {
  states_.resize(state.next_plane_id);
  for (const auto& record : records) {
    auto plane = std::make_unique<State>(*record->state);
    plane->merged = record->merged;
    plane->first_seen_utime = record->first_seen_utime;
    plane->last_seen_utime = record->last_seen_utime;
    plane->cells.reserve(record->cell_count);
    states_[record->id] = std::move(plane);
  }
  grid.for_each_cell([&](CellRef ref) {
    const PlaneSlot slot = grid.cell(ref).plane;
    if (slot == kNoSlot) return;
    this->state(slot).cells.push_back(ref);
    coarse_.add(grid.geometric_centre_m(ref), slot);
  });
  last_pose_ = state.last_pose;
  poses_err_ = poses_err_ || state.poses_err;
  pose_variance_m2_ = state.pose_variance_m2;
  scans_ = state.scans;
}

bool PlaneMap::update_records(std::uint64_t revision, std::vector<std::shared_ptr<const PlaneRecord>>& records,
                              std::vector<RemovedPlane>& removed) {
  if (!changed()) return false;
  const auto id_less = [](const std::shared_ptr<const PlaneRecord>& r, PlaneId id) { return r->id < id; };
  for (RemovedPlane gone : removed_) {
    const auto at = std::lower_bound(records.begin(), records.end(), gone.id, id_less);
    if (at == records.end() || (*at)->id != gone.id) continue;  // no reader ever saw it
    records.erase(at);
    gone.revision = revision;
    removed.push_back(gone);
  }
  sort_unique(dirty_);
  for (const PlaneSlot slot : dirty_) {
    if (!states_[slot]) continue;
    state(slot).dirty = false;
    const std::shared_ptr<PlaneRecord> record = record_pool_.take();
    write_record(slot, revision, *record);
    const auto at = std::lower_bound(records.begin(), records.end(), record->id, id_less);
    if (at != records.end() && (*at)->id == record->id) {
      *at = record;
    } else {
      records.insert(at, record);
    }
  }
  dirty_.clear();
  removed_.clear();
  return true;
}

}  // namespace planemap

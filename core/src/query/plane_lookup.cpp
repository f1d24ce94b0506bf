#include "planemap/query/plane_lookup.hpp"

#include <algorithm>
#include <planemap/coplanar.hpp>

#include "query/queries.hpp"

namespace planemap {

namespace {

PlaneDetails details_of(const QueryIndex& index, std::size_t plane) {
  std::vector<SizedPlane> sized;
  sized.reserve(index.planes.size());
  for (const DescribedPlane& other : index.planes) sized.push_back({other.record.get(), other.outline->area_m2});
  return {index.planes[plane], index.normal_deviations_rad[plane], coplanar_with(sized, plane)};
}

const RemovedPlane* find_removed(const MapSnapshot& snapshot, PlaneId id) {
  const auto removed = snapshot.removed();
  const auto at = std::find_if(removed.begin(), removed.end(), [&](const RemovedPlane& gone) { return gone.id == id; });
  return at == removed.end() ? nullptr : &*at;
}

/// The plane of the map that says it holds another one: also remembered of mergers that no snapshot ever told.
PlaneId holder_of(const QueryIndex& index, PlaneId id) {
  const auto holds = [&](const DescribedPlane& plane) {
    return std::binary_search(plane.record->merged.begin(), plane.record->merged.end(), id);
  };
  const auto at = std::find_if(index.planes.begin(), index.planes.end(), holds);
  return at == index.planes.end() ? kNoPlane : at->record->id;
}

}  // namespace

Expected<PlaneLookup> look_up(const QueryIndex& index, PlaneId id) {
  if (id == kNoPlane) return fail("id: must not be 0, which names no plane");
  PlaneLookup found;
  found.asked = id;
  const RemovedPlane* removed = find_removed(*index.snapshot, id);
  if (removed != nullptr) found.removed_revision = removed->revision;
  const bool was_seen = removed != nullptr || holder_of(index, id) != kNoPlane || index.find(id);
  if (!was_seen) return found;
  found.fate = PlaneFate::kGone;
  // Each plane is removed once, into one that lived on, so the way ends.
  for (PlaneId at = id; at != kNoPlane;) {
    found.lineage.push_back(at);
    if (const auto plane = index.find(at)) {
      found.fate = at == id ? PlaneFate::kLives : PlaneFate::kMerged;
      found.details = details_of(index, *plane);
      break;
    }
    const RemovedPlane* step = find_removed(*index.snapshot, at);
    at = step != nullptr ? step->merged_into : holder_of(index, at);
  }
  return found;
}

}  // namespace planemap

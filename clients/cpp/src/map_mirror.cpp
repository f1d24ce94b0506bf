#include "map_mirror.hpp"

#include <algorithm>
#include <utility>

namespace planemap::client {
namespace {

bool by_id(const Plane& a, const Plane& b) {
  return a.id < b.id;
}

std::vector<Plane>::iterator place_of(std::vector<Plane>& planes, std::int64_t id) {
  return std::lower_bound(planes.begin(), planes.end(), id, [](const Plane& p, std::int64_t i) { return p.id < i; });
}

/// A plane may get another class without a change of its own: by what was found to be the floor, for instance.
bool is_same(const Plane& a, const Plane& b) {
  return a.revision == b.revision && a.plane_class == b.plane_class;
}

void add_differences(const std::vector<Plane>& before, const std::vector<Plane>& after, MapChange& change) {
  auto old = before.begin();
  for (const Plane& plane : after) {
    for (; old != before.end() && old->id < plane.id; ++old) change.removed.push_back({old->id, 0});
    if (old == before.end() || old->id != plane.id) {
      change.added.push_back(plane.id);
      continue;
    }
    if (!is_same(*old, plane)) change.changed.push_back(plane.id);
    ++old;
  }
  for (; old != before.end(); ++old) change.removed.push_back({old->id, 0});
}

}  // namespace

MapChange MapMirror::no_change() const {
  MapChange change;
  change.epoch = map_.epoch;
  change.since_revision = change.revision = map_.revision;
  return change;
}

MapChange MapMirror::replace(Map map) {
  map.cells.clear();
  std::sort(map.planes.begin(), map.planes.end(), by_id);
  MapChange change;
  change.epoch = map.epoch;
  change.revision = map.revision;
  change.new_map = !has_map_ || map.epoch != map_.epoch;
  change.since_revision = change.new_map ? -1 : map_.revision;
  change.caught_up = true;
  add_differences(change.new_map ? std::vector<Plane>{} : map_.planes, map.planes, change);
  map_ = std::move(map);
  has_map_ = true;
  return change;
}

bool MapMirror::fits(const Delta& delta) const {
  if (!has_map_ || delta.epoch != map_.epoch)
    return delta.since_revision == 0 && (!has_map_ || delta.epoch > map_.epoch);
  return delta.since_revision <= map_.revision && delta.revision > map_.revision;
}

MapChange MapMirror::apply(Delta delta) {
  if (delta.since_revision == 0) {  // it is the whole map
    MapChange change = replace({std::move(delta.frame), delta.epoch, delta.revision, std::move(delta.planes), {}});
    change.caught_up = change.new_map;
    return change;
  }
  MapChange change;
  change.epoch = delta.epoch;
  change.since_revision = map_.revision;
  change.revision = delta.revision;
  for (const RemovedPlane& removed : delta.removed) {
    const auto at = place_of(map_.planes, removed.id);
    if (at == map_.planes.end() || at->id != removed.id) continue;  // it came and went between two deltas
    map_.planes.erase(at);
    change.removed.push_back(removed);
  }
  std::sort(delta.planes.begin(), delta.planes.end(), by_id);
  for (Plane& plane : delta.planes) {
    const auto at = place_of(map_.planes, plane.id);
    if (at == map_.planes.end() || at->id != plane.id) {
      change.added.push_back(plane.id);
      map_.planes.insert(at, std::move(plane));
    } else if (!is_same(*at, plane)) {
      change.changed.push_back(plane.id);
      *at = std::move(plane);
    }
  }
  map_.revision = delta.revision;
  return change;
}

}  // namespace planemap::client

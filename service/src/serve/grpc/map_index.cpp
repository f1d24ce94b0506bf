#include "serve/grpc/map_index.hpp"

#include <algorithm>
#include <utility>

namespace planemap::service {
namespace {

/// The index before, where it is of the same map.
const MapIndex* usable(const MapIndex* previous, const MapSnapshot& snapshot) {
  return previous != nullptr && previous->snapshot().epoch() == snapshot.epoch() ? previous : nullptr;
}

}  // namespace

MapIndex::MapIndex(const std::shared_ptr<const MapSnapshot>& snapshot, const std::optional<Eigen::Vector3d>& gravity,
                   const MapIndex* previous)
    : queries_(snapshot, gravity,
               usable(previous, *snapshot) != nullptr ? &usable(previous, *snapshot)->queries_ : nullptr) {
  const auto planes = queries_.planes();
  changed_revisions_.reserve(planes.size());
  previous = usable(previous, *snapshot);
  if (previous == nullptr) {
    // Nobody knows what the classes were before.
    changed_revisions_.assign(planes.size(), snapshot->revision());
    return;
  }
  const auto before = previous->queries_.planes();
  auto old = before.begin();  // both are by id
  for (const DescribedPlane& plane : planes) {
    while (old != before.end() && old->record->id < plane.record->id) ++old;
    std::uint64_t revision = plane.record->revision;
    if (old != before.end() && old->record->id == plane.record->id) {
      const bool is_of_new_class = old->plane_class != plane.plane_class;
      const auto place = static_cast<std::size_t>(old - before.begin());
      revision = is_of_new_class ? snapshot->revision() : std::max(revision, previous->changed_revisions_[place]);
    }
    changed_revisions_.push_back(revision);
  }
}

}  // namespace planemap::service

#include "serve/grpc/delta_pages.hpp"

#include <spdlog/fmt/fmt.h>

#include <optional>
#include <string>
#include <utility>

#include "codec/proto_answer_codec.hpp"
#include "serve/grpc/pages.hpp"

namespace planemap::service {
namespace {

using Reason = v1::SnapshotNeeded;

WatchEvents single(v1::WatchEvent event) {
  std::vector<v1::WatchEvent> events;
  events.push_back(std::move(event));
  return std::make_shared<const std::vector<v1::WatchEvent>>(std::move(events));
}

WatchEvents snapshot_needed(const MapSnapshot& snapshot, v1::SnapshotNeeded::Reason reason, std::string message) {
  v1::WatchEvent event;
  *event.mutable_map() = version_of(snapshot);
  event.mutable_snapshot_needed()->set_reason(reason);
  event.mutable_snapshot_needed()->set_message(std::move(message));
  return single(std::move(event));
}

WatchEvents other_map(const WatchPosition& position, const MapSnapshot& snapshot) {
  if (position.is_told) {
    return snapshot_needed(snapshot, Reason::REASON_NEW_MAP,
                           fmt::format("a new map has begun, epoch {}; take a snapshot", snapshot.epoch()));
  }
  if (position.epoch == 0) {
    return snapshot_needed(snapshot, Reason::REASON_NO_STATE, "no epoch was named; take a snapshot");
  }
  return snapshot_needed(
      snapshot, Reason::REASON_OTHER_EPOCH,
      fmt::format("epoch {} is not the map's, which is {}; take a snapshot", position.epoch, snapshot.epoch()));
}

/// Fills one event after the other.
class DeltaWriter {
 public:
  DeltaWriter(const MapSnapshot& snapshot, std::uint64_t since) {
    *empty_.mutable_map() = version_of(snapshot);
    empty_.mutable_delta()->set_since_revision(since);
    events_.push_back(empty_);
  }
  void add(v1::Plane plane) {
    cut_to_fit(plane, kMaxItemBytes);
    *delta_for(plane.ByteSizeLong()).add_changed() = std::move(plane);
  }
  void add(v1::RemovedPlane plane) { *delta_for(plane.ByteSizeLong()).add_removed() = std::move(plane); }
  WatchEvents take() {
    events_.back().mutable_delta()->set_last(true);
    return std::make_shared<const std::vector<v1::WatchEvent>>(std::move(events_));
  }

 private:
  v1::Delta& delta_for(std::size_t bytes) {
    if (!room_.take(bytes)) {
      room_ = {};
      room_.take(bytes);
      events_.push_back(empty_);
      events_.back().mutable_delta()->set_page(static_cast<std::uint32_t>(events_.size() - 1));
    }
    return *events_.back().mutable_delta();
  }

  v1::WatchEvent empty_;
  std::vector<v1::WatchEvent> events_;
  PageRoom room_;
};

WatchEvents delta_of(const MapIndex& index, const MapDelta& delta) {
  DeltaWriter writer(index.snapshot(), delta.since_revision);
  const auto planes = index.queries().planes();
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (index.changed_revisions()[i] > delta.since_revision) writer.add(to_proto(planes[i]));
  }
  for (const RemovedPlane& gone : delta.removed) writer.add(to_proto(gone));
  return writer.take();
}

}  // namespace

WatchEvents DeltaPages::between(const WatchPosition& position, const std::shared_ptr<const MapIndex>& index) {
  const MapSnapshot& snapshot = index->snapshot();
  if (position.epoch != snapshot.epoch()) return other_map(position, snapshot);
  if (position.revision == snapshot.revision()) return nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (index == index_) {
      const auto kept = by_revision_.find(position.revision);
      if (kept != by_revision_.end()) return kept->second;
    }
  }
  if (position.revision > snapshot.revision()) {
    return snapshot_needed(snapshot, Reason::REASON_REVISION_UNKNOWN,
                           fmt::format("revision {} is unknown: the map is at {}; take a snapshot", position.revision,
                                       snapshot.revision()));
  }
  const auto delta = snapshot.delta_since(position.revision);
  if (!delta) {
    return snapshot_needed(
        snapshot, Reason::REASON_REVISION_TOO_OLD,
        fmt::format("what was removed since revision {} is not known any more; take a snapshot", position.revision));
  }
  auto events = delta_of(*index, *delta);
  const std::lock_guard lock(mutex_);
  if (index != index_) {
    index_ = index;
    by_revision_.clear();
  }
  by_revision_.emplace(position.revision, events);
  return events;
}

WatchEvents heartbeat_event(const MapSnapshot& snapshot) {
  v1::WatchEvent event;
  *event.mutable_map() = version_of(snapshot);
  event.mutable_heartbeat();
  return single(std::move(event));
}

}  // namespace planemap::service

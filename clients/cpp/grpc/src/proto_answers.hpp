#pragma once

#include <planemap/v1/map.pb.h>
#include <planemap/v1/planemap_service.pb.h>
#include <planemap/v1/queries.pb.h>

#include <planemap/client/map_watch.hpp>
#include <planemap/client/query_types.hpp>

namespace planemap::client {

// From messages of planemap.v1 to plain types. Each says whether the message was sound: numbers finite, lists of the
// right lengths, ids possible; what it has read of one that is not is to be thrown away.

bool read(const v1::MapVersion& message, MapVersion& version);
bool read(const v1::Plane& message, Plane& plane);
bool read(const v1::Cell& message, Cell& cell);
bool read(const v1::RemovedPlane& message, RemovedPlane& removed);
bool read(const v1::NearPlane& message, NearPlane& plane);
bool read(const v1::RayHits& message, RayHits& hits);
bool read(const v1::RegionPlane& message, RegionPlane& plane);
bool read(const v1::GetPlaneResponse& message, PlaneAnswer& answer);
bool read(const v1::GetFloorPlanResponse& message, FloorplanAnswer& plan);
bool read(const v1::GetStatusResponse& message, Status& status);

/// Adds what a list of messages holds to one of plain types.
template <class Messages, class Items>
bool read_all(const Messages& messages, Items& items) {
  bool sound = true;
  for (const auto& message : messages) sound &= read(message, items.emplace_back());
  return sound;
}

}  // namespace planemap::client

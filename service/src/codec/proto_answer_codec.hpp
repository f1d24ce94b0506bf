#pragma once

#include <planemap/v1/cells.pb.h>
#include <planemap/v1/map.pb.h>
#include <planemap/v1/planes.pb.h>
#include <planemap/v1/queries.pb.h>

#include <cstddef>
#include <planemap/described_plane.hpp>
#include <planemap/query/floorplan.hpp>
#include <planemap/query/nearest.hpp>
#include <planemap/query/plane_lookup.hpp>
#include <planemap/query/ray_cast.hpp>
#include <planemap/query/region.hpp>
#include <planemap/snapshot.hpp>

namespace planemap::service {

// From core's answers to messages of planemap.v1.

v1::MapVersion version_of(const MapSnapshot& snapshot);
v1::Plane to_proto(const DescribedPlane& plane);
v1::Cell to_proto(const CellView& cell);
v1::RemovedPlane to_proto(const RemovedPlane& removed);
v1::NearPlane to_proto(const NearPlane& plane);
v1::RayHits to_proto(const RayHits& hits);
v1::RegionPlane to_proto(const RegionPlane& plane);
/// The map's version is left to the caller. @pre the lookup's plane is known
v1::GetPlaneResponse to_proto(const PlaneLookup& lookup);
/// The map's version is left to the caller.
v1::GetFloorPlanResponse to_proto(const Floorplan& plan);

/// Leaves out the smallest polygons of an outline, then holes, until the message takes at most so many bytes; planes of
/// more than 100,000 corners need it. Area and all other fields stay. @return whether something had to go
bool cut_to_fit(v1::Plane& plane, std::size_t max_bytes);

}  // namespace planemap::service

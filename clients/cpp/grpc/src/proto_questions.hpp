#pragma once

#include <planemap/v1/queries.pb.h>

#include <planemap/client/query_types.hpp>
#include <span>

namespace planemap::client {

// From plain types to requests of planemap.v1. @pre the checks of query_checks.hpp found nothing

v1::NearestPlanesRequest nearest_message(std::span<const QueryPoint> points, const NearestOptions& options);
v1::CastRaysRequest rays_message(std::span<const Ray> rays, const CastOptions& options);
v1::QueryRegionRequest region_message(const RegionQuery& query);
v1::GetFloorPlanRequest floorplan_message(const FloorplanQuery& query);

}  // namespace planemap::client

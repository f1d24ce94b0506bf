#pragma once

#include <planemap/expected.hpp>
#include <planemap/query/floorplan.hpp>
#include <planemap/query/nearest.hpp>
#include <planemap/query/plane_lookup.hpp>
#include <planemap/query/ray_cast.hpp>
#include <planemap/query/region.hpp>
#include <span>
#include <vector>

#include "query/query_index.hpp"

namespace planemap {

// What SnapshotQueries answers with; described there.

Expected<std::vector<NearPlane>> nearest_planes(const QueryIndex& index, const NearestQuery& query);
Expected<std::vector<RayHits>> cast_rays(const QueryIndex& index, std::span<const Ray> rays,
                                         const CastOptions& options);
Expected<RegionContents> contents_of(const QueryIndex& index, const RegionQuery& query);
Expected<PlaneLookup> look_up(const QueryIndex& index, PlaneId id);
Expected<Floorplan> floorplan_of(const QueryIndex& index, const FloorplanQuery& query);

}  // namespace planemap

#pragma once

#include <cstddef>
#include <planemap/expected.hpp>
#include <planemap/query/floorplan.hpp>
#include <planemap/query/nearest.hpp>
#include <planemap/query/plane_filter.hpp>
#include <planemap/query/ray_cast.hpp>
#include <planemap/query/region.hpp>
#include <vector>

namespace planemap::v1 {
class CastRaysRequest;
class GetFloorPlanRequest;
class NearestPlanesRequest;
class PlaneFilter;
class QueryRegionRequest;
}  // namespace planemap::v1

namespace planemap::service {

/// Keeps the answer to a batch below 1 MiB.
constexpr std::size_t kMaxNearestPlanes = 5000;  ///< points times planes for each
constexpr std::size_t kMaxRays = 2000;

// From requests of planemap.v1 to core's queries. What is checked here is what a message can have wrong that a query
// cannot (a part that is missing, a list of the wrong length); the numbers' limits are the queries' own to check.
// Errors name the field.

Expected<PlaneFilter> to_filter(const v1::PlaneFilter& message);
/// One query for each point; at least one.
Expected<std::vector<NearestQuery>> to_queries(const v1::NearestPlanesRequest& message);

struct RayQuery {
  std::vector<Ray> rays;  ///< at least one
  CastOptions options;
};
Expected<RayQuery> to_query(const v1::CastRaysRequest& message);
Expected<RegionQuery> to_query(const v1::QueryRegionRequest& message);
Expected<FloorplanQuery> to_query(const v1::GetFloorPlanRequest& message);

}  // namespace planemap::service

#pragma once

#include <planemap/expected.hpp>
#include <planemap/query/snapshot_queries.hpp>
#include <planemap_lcm/filter_t.hpp>
#include <planemap_lcm/floorplan_query_t.hpp>
#include <planemap_lcm/nearest_query_t.hpp>
#include <planemap_lcm/rays_query_t.hpp>
#include <planemap_lcm/region_query_t.hpp>
#include <vector>

namespace planemap::service {

/// Points and rays that one request may bring: it stays below the greatest page.
constexpr std::size_t kMostPoints = 700;
constexpr std::size_t kMostRays = 700;
/// Planes that are named for each point.
constexpr std::int32_t kMostNearPlanes = 1000;

// From the wire to the core's queries. Fails where the core has no words for what was sent (a class or a shape that
// does not exist, no point at all); the core checks the rest. Errors name the member, its limit and what it was.

Expected<PlaneFilter> to_filter(const planemap_lcm::filter_t& wire);

/// A query for each point.
Expected<std::vector<NearestQuery>> to_queries(const planemap_lcm::nearest_query_t& wire, const PlaneFilter& filter);

struct RaysQuery {
  std::vector<Ray> rays;
  CastOptions options;
};
Expected<RaysQuery> to_query(const planemap_lcm::rays_query_t& wire, const PlaneFilter& filter);

Expected<RegionQuery> to_query(const planemap_lcm::region_query_t& wire, const PlaneFilter& filter);

FloorplanQuery to_query(const planemap_lcm::floorplan_query_t& wire, const PlaneFilter& filter);

}  // namespace planemap::service

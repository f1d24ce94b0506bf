#pragma once

#include <cstdint>
#include <planemap/client/query_types.hpp>
#include <planemap_lcm/request_t.hpp>
#include <span>

namespace planemap::client {

// Questions as requests. Who asks, under which id and for which page is set where they are sent.

/// A request that takes no arguments.
planemap_lcm::request_t request_for(std::int16_t operation);
planemap_lcm::request_t nearest_request(std::span<const QueryPoint> points, const NearestOptions& options);
planemap_lcm::request_t rays_request(std::span<const Ray> rays, const CastOptions& options);
planemap_lcm::request_t region_request(const RegionQuery& query);
planemap_lcm::request_t plane_request(std::int64_t id);
planemap_lcm::request_t floorplan_request(const FloorplanQuery& query);

}  // namespace planemap::client

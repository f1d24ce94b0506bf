#pragma once

#include <planemap/client/map_types.hpp>
#include <planemap/client/query_types.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <vector>

namespace planemap::client {

// The pages of whole answers as plain types. Fail (kMalformed) where what must be there is not.

using Replies = std::vector<planemap_lcm::reply_t>;

/// @pre there is a page
MapVersion version_of(const Replies& pages);
Expected<Status> status_of_pages(const Replies& pages);
/// Adds what was found for the next `count` points.
Expected<void> add_nearest(const Replies& pages, std::size_t count, NearestAnswer& answer);
/// The same for rays.
Expected<void> add_hits(const Replies& pages, std::size_t count, CastAnswer& answer);
RegionAnswer region_of_pages(const Replies& pages);
Expected<PlaneAnswer> plane_of_pages(const Replies& pages);
Expected<FloorplanAnswer> floorplan_of_pages(const Replies& pages);

}  // namespace planemap::client

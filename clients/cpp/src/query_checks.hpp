#pragma once

#include <cstdint>
#include <planemap/client/query_types.hpp>
#include <span>

namespace planemap::client {

// What is wrong with a question whatever the map is, beside what the map's own checks find: arguments that have no form
// on one of the wires. Errors (kRefused) name the argument, its limit and what it was.

Expected<void> check_query(std::span<const QueryPoint> points, const NearestOptions& options);
Expected<void> check_query(std::span<const Ray> rays, const CastOptions& options);
Expected<void> check_filter(const PlaneFilter& filter);
Expected<void> check_plane_id(std::int64_t id);

}  // namespace planemap::client

#pragma once

#include <planemap/query/snapshot_queries.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <span>
#include <vector>

namespace planemap::service {

// Answers of the core as the lists of a reply_t. Counts and page numbers are set by encode_pages().

void add_to(planemap_lcm::reply_t& reply, const DescribedPlane& plane);
/// @param point  which of the query's points the planes are near to
void add_to(planemap_lcm::reply_t& reply, std::span<const NearPlane> planes, std::size_t point);
void add_to(planemap_lcm::reply_t& reply, std::span<const RayHits> hits);
void add_to(planemap_lcm::reply_t& reply, const RegionContents& contents);
void add_to(planemap_lcm::reply_t& reply, const PlaneLookup& lookup);
void add_to(planemap_lcm::reply_t& reply, const Floorplan& plan);

}  // namespace planemap::service

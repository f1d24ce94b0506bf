#pragma once

#include <cstdint>
#include <planemap_lcm/cell_t.hpp>
#include <planemap_lcm/plane_t.hpp>
#include <planemap_lcm/polygon_t.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <span>

namespace planemap::client {

/// Whether the counts of a message agree with its size: generated decoders take memory for a count before they look.
bool reply_counts_agree(std::span<const std::uint8_t> bytes);
/// The same for a planes_t.
bool delta_counts_agree(std::span<const std::uint8_t> bytes);

// Whether numbers are finite, polygons whole, ids and counts possible.
bool is_sound(const planemap_lcm::polygon_t& polygon);
bool is_sound(const planemap_lcm::plane_t& plane);
bool is_sound(const planemap_lcm::cell_t& cell);
bool is_sound(const planemap_lcm::near_plane_t& near);
bool is_sound(const planemap_lcm::plane_hit_t& hit);
bool is_sound(const planemap_lcm::cell_hit_t& hit);
bool is_sound(const planemap_lcm::region_plane_t& plane);
bool is_sound(const planemap_lcm::floorplan_t& plan);
bool is_sound(const planemap_lcm::plan_polygon_t& polygon);
bool is_sound(const planemap_lcm::plane_lookup_t& lookup);
/// What is wrong with the lists of a reply; nullptr: nothing.
const char* unsound_part(const planemap_lcm::reply_t& reply);

/// More pages than this are no answer: 60 GB.
constexpr int kMaxPages = 1'000'000;

}  // namespace planemap::client

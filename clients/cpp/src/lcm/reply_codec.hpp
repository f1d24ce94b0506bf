#pragma once

#include <cstdint>
#include <planemap/client/map_types.hpp>
#include <planemap/client/query_types.hpp>
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <span>
#include <string>
#include <vector>

namespace planemap::client {

/// Decodes a page of a reply. Every count is checked against the message's size before memory is taken for it, and the
/// page is checked to make sense by itself; the error says what is wrong.
tl::expected<planemap_lcm::reply_t, std::string> decode_reply(std::span<const std::uint8_t> bytes);

/// The same for a page of a delta.
tl::expected<planemap_lcm::planes_t, std::string> decode_delta(std::span<const std::uint8_t> bytes);

/// Of which map a status_t tells.
tl::expected<MapVersion, std::string> decode_status_version(std::span<const std::uint8_t> bytes);

/// Joins the pages of a whole answer, in order of page number.
Map map_of(const std::vector<planemap_lcm::reply_t>& pages);

}  // namespace planemap::client

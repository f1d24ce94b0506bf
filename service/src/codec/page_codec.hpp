#pragma once

#include <cstdint>
#include <planemap/expected.hpp>
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <vector>

namespace planemap::service {

/// Encoded messages; each stands for itself.
using Page = std::vector<std::uint8_t>;
using Pages = std::vector<Page>;

/// Splits a delta into messages of at most page_bytes; there is always one. The header's counts and page numbers are
/// set here.
/// @param cell_size_m  for planes whose boundary has to become coarser to fit in a page
Pages encode_pages(planemap_lcm::planes_t header, std::vector<planemap_lcm::plane_t> planes,
                   const std::vector<planemap_lcm::removed_plane_t>& removed, std::size_t page_bytes,
                   double cell_size_m);

/// Splits a whole answer, its lists as long as they may be, into replies of at most page_bytes, in the order of its
/// lists. Fails, and says what it is, where one item is too large for a page of its own.
Expected<Pages> encode_pages(planemap_lcm::reply_t answer, std::size_t page_bytes, double cell_size_m);

/// Addresses an encoded reply_t to another request.
void restamp_reply(Page& page, std::int64_t utime, std::int64_t request_id);

/// Encodes one message. Throws std::runtime_error if the message's counts and vectors do not agree.
template <class Message>
Page encode(const Message& message);

}  // namespace planemap::service

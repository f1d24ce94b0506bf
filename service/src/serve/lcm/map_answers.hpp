#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <planemap/query/snapshot_queries.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <string>

#include "codec/request_codec.hpp"

namespace planemap::service {

/// More than this is not sent over a datagram bus: some five million cells.
constexpr std::size_t kMaxReplyBytes = std::size_t{256} << 20;

/// Why a request gets no answer: a status of reply_t, and a sentence.
struct Refusal {
  std::int8_t status = 0;
  std::string message;
};

/// Whether an operation asks the map, as opposed to the service.
bool is_map_operation(std::int16_t operation);
/// The operations that there are, for messages: "1 status, 2 snapshot, ...".
std::string known_operations();

/// What is wrong with a request whatever the map is; empty: nothing.
std::optional<Refusal> check_arguments(const Request& request);

/// Answers what a request asks of the map by filling the answer's lists.
/// @pre is_map_operation(request.operation), and check_arguments() found nothing
/// @return why there is no answer; empty: there is
std::optional<Refusal> answer_from(const SnapshotQueries& queries, const Request& request,
                                   planemap_lcm::reply_t& answer, std::size_t max_reply_bytes = kMaxReplyBytes);

}  // namespace planemap::service

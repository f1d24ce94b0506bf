#pragma once

#include <cstdint>
#include <planemap_lcm/request_t.hpp>
#include <span>
#include <string>
#include <vector>

#include "codec/rejection.hpp"

namespace planemap::service {

/// A planemap_lcm.request_t.
struct Request {
  std::int64_t request_id = 0;
  std::string reply_channel;
  std::int16_t operation = 0;
  std::int64_t epoch = 0;                    ///< with page >= 0: of the reply whose page was lost
  std::int64_t revision = 0;                 ///< the same
  std::int32_t page = -1;                    ///< -1: all
  planemap_lcm::request_t arguments{};       ///< the message; of it the filter and the queries count
  std::vector<std::uint8_t> argument_bytes;  ///< those as they were sent: equal bytes ask the same
};

/// Decodes planemap_lcm.request_t as far as it can be answered: what is wrong with the operation, the page or the
/// queries is left to the answer, as long as there is a channel to answer on. Takes no more memory than a few times the
/// message's size.
Decoded<Request> decode_request(std::span<const std::uint8_t> message);

}  // namespace planemap::service

#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "codec/scan_codec.hpp"

namespace planemap::service {

/// A planemap_lcm.request_t.
struct Request {
  std::int64_t request_id = 0;
  std::string reply_channel;
  std::int16_t operation = 0;
  std::int64_t epoch = 0;     ///< with page >= 0: of the reply whose page was lost
  std::int64_t revision = 0;  ///< the same
  std::int32_t page = -1;     ///< -1: all
};

/// Decodes planemap_lcm.request_t as far as it can be answered: what is wrong with the operation or the page is left to
/// the answer, as long as there is a channel to answer on.
Decoded<Request> decode_request(std::span<const std::uint8_t> message);

}  // namespace planemap::service

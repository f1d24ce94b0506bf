#pragma once

#include <algorithm>
#include <planemap/client/query_types.hpp>
#include <span>
#include <string>

#include "deadline.hpp"

namespace planemap::client {

/// Asks about many items, so many at a time, all of one revision. Where that is gone in between, all is asked anew.
/// @param begin     called before each try; forgets what the last one brought
/// @param ask_part  (items, version, timeout) -> Expected<MapVersion>: keeps what is answered about these items, and
///                  says of which version it is. The version is that of the parts before (0, 0: any); where the answer
///                  can't be of that one it fails (kGone).
template <class Item, class Begin, class AskPart>
Expected<void> ask_in_parts(std::span<const Item> items, std::size_t most_at_a_time, std::chrono::milliseconds timeout,
                            const Begin& begin, const AskPart& ask_part) {
  const Deadline deadline(timeout);
  bool is_first = true;
  do {
    begin();
    MapVersion version;
    std::size_t at = 0;
    do {
      const auto part = items.subspan(at, std::min(most_at_a_time, items.size() - at));
      auto answered = ask_part(part, version, deadline.left());
      if (!answered) {
        const bool is_gone = answered.error().kind == Error::Kind::kGone;
        if (is_gone || (!is_first && deadline.is_over())) break;
        if (at > 0) answered.error().message += " (from item " + std::to_string(at) + " on)";
        return tl::make_unexpected(answered.error());
      }
      version = *answered;
      at += part.size();
      if (at >= items.size()) return {};
    } while (true);
    is_first = false;
  } while (!deadline.is_over());
  return incomplete("the map changed faster than all could be asked of one revision; there was no answer", timeout);
}

}  // namespace planemap::client

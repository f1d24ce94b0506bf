#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <planemap_lcm/planes_t.hpp>
#include <vector>

#include "map_mirror.hpp"

namespace planemap::client {

/// Puts the pages of deltas together, in whatever order and number they come.
class DeltaCollector {
 public:
  /// @return the delta, where this was the last page that it lacked
  std::optional<Delta> add(planemap_lcm::planes_t page);

 private:
  struct Open {
    std::int64_t epoch = 0;
    std::int64_t since_revision = 0;
    std::int64_t revision = 0;
    std::vector<bool> have;
    std::size_t received = 0;
    std::vector<planemap_lcm::planes_t> pages;
  };
  std::deque<Open> open_;  ///< the newest behind; the oldest of many are given up
};

}  // namespace planemap::client

#include "lcm/delta_collector.hpp"

#include <algorithm>
#include <utility>

#include "lcm/wire_types.hpp"

namespace planemap::client {
namespace {

/// Deltas that are on their way at the same time: with five a second, what is older is lost.
constexpr std::size_t kMostOpen = 8;

Delta joined(const std::vector<planemap_lcm::planes_t>& pages) {
  Delta delta;
  delta.epoch = pages.front().epoch;
  delta.since_revision = pages.front().since_revision;
  delta.revision = pages.front().revision;
  delta.frame = pages.front().frame;
  for (const auto& page : pages) {
    for (const auto& plane : page.planes) delta.planes.push_back(plane_of(plane));
    for (const auto& removed : page.removed) delta.removed.push_back({removed.id, removed.merged_into});
  }
  return delta;
}

}  // namespace

std::optional<Delta> DeltaCollector::add(planemap_lcm::planes_t page) {
  const auto count = static_cast<std::size_t>(page.page_count);
  auto open = std::find_if(open_.begin(), open_.end(), [&](const Open& o) {
    return o.epoch == page.epoch && o.since_revision == page.since_revision && o.revision == page.revision &&
           o.have.size() == count;
  });
  if (open == open_.end()) {
    if (open_.size() == kMostOpen) open_.pop_front();
    open_.push_back({page.epoch, page.since_revision, page.revision, std::vector<bool>(count, false), 0, {}});
    open = std::prev(open_.end());
  }
  const auto number = static_cast<std::size_t>(page.page);
  if (open->have[number]) return std::nullopt;
  open->have[number] = true;
  ++open->received;
  open->pages.push_back(std::move(page));
  if (open->received < count) return std::nullopt;
  Delta delta = joined(open->pages);
  open_.erase(open);
  return delta;
}

}  // namespace planemap::client

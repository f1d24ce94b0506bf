#include "lcm/wire_queries.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "lcm/query_requests.hpp"
#include "lcm/reply_codec.hpp"
#include "query_checks.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::request_t;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// What one request may bring at most, as lcmtypes/planemap_lcm says.
constexpr std::size_t kMostInARequest = 700;

tl::unexpected<Error> incomplete(const std::string& what, milliseconds timeout) {
  return tl::make_unexpected(Error{Error::Kind::kIncomplete, what + " within " + seconds_text(timeout)});
}

/// The time for a call that asks more than once.
class Deadline {
 public:
  explicit Deadline(milliseconds timeout) : timeout_(timeout), end_(Clock::now() + timeout) {}
  milliseconds timeout() const { return timeout_; }
  milliseconds left() const {
    return std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(end_ - Clock::now()));
  }

 private:
  milliseconds timeout_;
  Clock::time_point end_;
};

/// Asks about many items, so many at a time, all of one revision. Where that is gone in between, all is asked anew.
/// @param request_of  (items) -> request_t
/// @param add         (pages, number of items) -> Expected<void>; takes what a request brought
template <class Item, class RequestOf, class Begin, class Add>
Expected<void> ask_in_parts(const WireQueries::Ask& ask, std::span<const Item> items, milliseconds timeout,
                            const RequestOf& request_of, const Begin& begin, const Add& add) {
  const Deadline deadline(timeout);
  bool is_first = true;
  do {
    begin();
    MapVersion version;
    std::size_t at = 0;
    bool is_gone = false;
    do {
      const auto part = items.subspan(at, std::min(kMostInARequest, items.size() - at));
      request_t request = request_of(part);
      request.epoch = version.epoch;
      request.revision = version.revision;
      auto pages = ask(request, deadline.left());
      is_gone = !pages && pages.error().kind == Error::Kind::kGone;
      if (is_gone || (!pages && !is_first && deadline.left() == milliseconds(0))) break;
      if (!pages && at > 0) pages.error().message += " (from item " + std::to_string(at) + " on)";
      if (!pages) return tl::make_unexpected(pages.error());
      version = version_of(*pages);
      if (auto added = add(*pages, part.size()); !added) return added;
      at += part.size();
    } while (at < items.size());
    if (at >= items.size() && !is_gone) return {};
    is_first = false;
  } while (deadline.left() > milliseconds(0));
  return incomplete("the map changed faster than all could be asked of one revision; there was no answer", timeout);
}

}  // namespace

std::string seconds_text(milliseconds time) {
  char text[32];
  std::snprintf(text, sizeof text, "%g s", static_cast<double>(time.count()) / 1000.0);
  return text;
}

WireQueries::WireQueries(Ask ask) : ask_(std::move(ask)) {}

Expected<Status> WireQueries::status(milliseconds timeout) const {
  return ask_(request_for(request_t::OPERATION_STATUS), timeout).and_then(status_of_pages);
}

Expected<Map> WireQueries::snapshot(milliseconds timeout) const {
  return ask_(request_for(request_t::OPERATION_SNAPSHOT), timeout).map(map_of);
}

Expected<Map> WireQueries::cells(milliseconds timeout) const {
  return ask_(request_for(request_t::OPERATION_CELLS), timeout).map(map_of);
}

Expected<Map> WireQueries::whole_map(milliseconds timeout) const {
  const Deadline deadline(timeout);
  bool is_first = true;
  do {
    auto map = snapshot(deadline.left());
    if (!map && !is_first && deadline.left() == milliseconds(0)) break;  // the time ran out on a later try
    if (!map) return map;
    is_first = false;
    request_t for_cells = request_for(request_t::OPERATION_CELLS);
    for_cells.epoch = map->epoch;
    for_cells.revision = map->revision;
    auto cells = ask_(for_cells, deadline.left()).map(map_of);
    if (!cells && cells.error().kind == Error::Kind::kUnreachable) {
      return incomplete("the planes came, but no cells", timeout);
    }
    if (!cells && cells.error().kind != Error::Kind::kGone) return cells;
    if (cells && cells->epoch == map->epoch && cells->revision == map->revision) {
      map->cells = std::move(cells->cells);
      return map;
    }
  } while (deadline.left() > milliseconds(0));
  return incomplete(
      "the map changed faster than its planes and cells could be asked for; there were no two of one revision",
      timeout);
}

Expected<NearestAnswer> WireQueries::nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                             milliseconds timeout) const {
  if (auto good = check_query(points, options); !good) return tl::make_unexpected(good.error());
  NearestAnswer answer;
  auto asked = ask_in_parts(
      ask_, points, timeout, [&](std::span<const QueryPoint> part) { return nearest_request(part, options); },
      [&] { answer = {}; }, [&](const Replies& pages, std::size_t count) { return add_nearest(pages, count, answer); });
  if (!asked) return tl::make_unexpected(asked.error());
  return answer;
}

Expected<CastAnswer> WireQueries::cast(std::span<const Ray> rays, const CastOptions& options,
                                       milliseconds timeout) const {
  if (auto good = check_query(rays, options); !good) return tl::make_unexpected(good.error());
  CastAnswer answer;
  auto asked = ask_in_parts(
      ask_, rays, timeout, [&](std::span<const Ray> part) { return rays_request(part, options); }, [&] { answer = {}; },
      [&](const Replies& pages, std::size_t count) { return add_hits(pages, count, answer); });
  if (!asked) return tl::make_unexpected(asked.error());
  return answer;
}

Expected<RegionAnswer> WireQueries::region(const RegionQuery& query, milliseconds timeout) const {
  if (auto good = check_filter(query.filter); !good) return tl::make_unexpected(good.error());
  return ask_(region_request(query), timeout).map(region_of_pages);
}

Expected<PlaneAnswer> WireQueries::plane(std::int64_t id, milliseconds timeout) const {
  return ask_(plane_request(id), timeout).and_then(plane_of_pages);
}

Expected<FloorplanAnswer> WireQueries::floorplan(const FloorplanQuery& query, milliseconds timeout) const {
  if (auto good = check_filter(query.filter); !good) return tl::make_unexpected(good.error());
  return ask_(floorplan_request(query), timeout).and_then(floorplan_of_pages);
}

}  // namespace planemap::client

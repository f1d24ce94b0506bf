#include "planemap/client/wire_map_client.hpp"

#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "ask_in_parts.hpp"
#include "deadline.hpp"
#include "lcm/query_answers.hpp"
#include "lcm/query_requests.hpp"
#include "lcm/reply_codec.hpp"
#include "query_checks.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::request_t;
using std::chrono::milliseconds;

/// What one request may bring at most, as lcmtypes/planemap_lcm says.
constexpr std::size_t kMostInARequest = 700;

/// The request has the same few members for all shapes; whoever asks knows a shape's own.
Error by_the_names_of(const RegionQuery& query, Error error) {
  using Names = std::vector<std::pair<std::string_view, std::string_view>>;
  const Names of_box = {{"box.from_m", "box.min_m"}, {" to_m's ", " max_m's "}};
  const Names of_sphere = {{"sphere.from_m", "sphere.centre_m"}};
  const Names of_pose = {{".from_m", ".pose.position_m"}, {".rotation_wxyz", ".pose.rotation_wxyz"}};
  const bool has_pose =
      std::holds_alternative<OrientedBox>(query.region) || std::holds_alternative<Frustum>(query.region);
  const Names names = std::holds_alternative<Box>(query.region)      ? of_box
                      : std::holds_alternative<Sphere>(query.region) ? of_sphere
                      : has_pose                                     ? of_pose
                                                                     : Names();
  for (const auto& [wire, own] : names) {
    const auto at = error.message.find(wire);
    if (at != std::string::npos) error.message.replace(at, wire.size(), own);
  }
  return error;
}

}  // namespace

/// Asks of that version, and adds what the pages of the answer bring.
template <class Add>
Expected<MapVersion> WireMapClient::ask_part(request_t request, const MapVersion& version, milliseconds timeout,
                                             const Add& add) {
  request.epoch = version.epoch;
  request.revision = version.revision;
  const auto pages = ask(request, timeout);
  if (!pages) return tl::make_unexpected(pages.error());
  if (auto added = add(*pages); !added) return tl::make_unexpected(added.error());
  return version_of(*pages);
}

Expected<Status> WireMapClient::status(milliseconds timeout) {
  return ask(request_for(request_t::OPERATION_STATUS), timeout).and_then(status_of_pages);
}

Expected<Map> WireMapClient::snapshot(milliseconds timeout) {
  return ask(request_for(request_t::OPERATION_SNAPSHOT), timeout).map(map_of);
}

Expected<Map> WireMapClient::cells(milliseconds timeout) {
  return ask(request_for(request_t::OPERATION_CELLS), timeout).map(map_of);
}

Expected<Map> WireMapClient::whole_map(milliseconds timeout) {
  const Deadline deadline(timeout);
  bool is_first = true;
  do {
    auto map = snapshot(deadline.left());
    if (!map && !is_first && deadline.is_over()) break;  // the time ran out on a later try
    if (!map) return map;
    is_first = false;
    request_t for_cells = request_for(request_t::OPERATION_CELLS);
    for_cells.epoch = map->epoch;
    for_cells.revision = map->revision;
    auto cells = ask(for_cells, deadline.left()).map(map_of);
    if (!cells && cells.error().kind == Error::Kind::kUnreachable) {
      return incomplete("the planes came, but no cells", timeout);
    }
    if (!cells && cells.error().kind != Error::Kind::kGone) return cells;
    if (cells && cells->epoch == map->epoch && cells->revision == map->revision) {
      map->cells = std::move(cells->cells);
      return map;
    }
  } while (!deadline.is_over());
  return incomplete(
      "the map changed faster than its planes and cells could be asked for; there were no two of one revision",
      timeout);
}

Expected<NearestAnswer> WireMapClient::nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                               milliseconds timeout) {
  if (auto good = check_query(points, options); !good) return tl::make_unexpected(good.error());
  NearestAnswer answer;
  const auto asked = ask_in_parts(
      points, kMostInARequest, timeout, [&] { answer = {}; },
      [&](std::span<const QueryPoint> part, const MapVersion& version, milliseconds left) {
        return ask_part(nearest_request(part, options), version, left,
                        [&](const Replies& pages) { return add_nearest(pages, part.size(), answer); });
      });
  if (!asked) return tl::make_unexpected(asked.error());
  return answer;
}

Expected<CastAnswer> WireMapClient::cast(std::span<const Ray> rays, const CastOptions& options, milliseconds timeout) {
  if (auto good = check_query(rays, options); !good) return tl::make_unexpected(good.error());
  CastAnswer answer;
  const auto asked = ask_in_parts(
      rays, kMostInARequest, timeout, [&] { answer = {}; },
      [&](std::span<const Ray> part, const MapVersion& version, milliseconds left) {
        return ask_part(rays_request(part, options), version, left,
                        [&](const Replies& pages) { return add_hits(pages, part.size(), answer); });
      });
  if (!asked) return tl::make_unexpected(asked.error());
  return answer;
}

Expected<RegionAnswer> WireMapClient::region(const RegionQuery& query, milliseconds timeout) {
  if (auto good = check_filter(query.filter); !good) return tl::make_unexpected(good.error());
  return ask(region_request(query), timeout).map(region_of_pages).map_error([&](Error error) {
    return by_the_names_of(query, std::move(error));
  });
}

Expected<PlaneAnswer> WireMapClient::plane(std::int64_t id, milliseconds timeout) {
  if (auto good = check_plane_id(id); !good) return tl::make_unexpected(good.error());
  return ask(plane_request(id), timeout).and_then(plane_of_pages);
}

Expected<FloorplanAnswer> WireMapClient::floorplan(const FloorplanQuery& query, milliseconds timeout) {
  if (auto good = check_filter(query.filter); !good) return tl::make_unexpected(good.error());
  return ask(floorplan_request(query), timeout).and_then(floorplan_of_pages);
}

}  // namespace planemap::client

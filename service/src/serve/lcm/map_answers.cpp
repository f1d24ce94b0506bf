#include "serve/lcm/map_answers.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <planemap_lcm/cell_t.hpp>
#include <string_view>
#include <utility>

#include "codec/answer_codec.hpp"
#include "codec/plane_codec.hpp"
#include "codec/query_codec.hpp"
#include "serve/argument_names.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::reply_t;
using planemap_lcm::request_t;

struct Operation {
  std::int16_t number;
  const char* name;
  const char* query;  ///< the list of request_t that it takes one query from; nullptr: none
};

constexpr std::array<Operation, 8> kOperations = {{{request_t::OPERATION_STATUS, "status", nullptr},
                                                   {request_t::OPERATION_SNAPSHOT, "snapshot", nullptr},
                                                   {request_t::OPERATION_CELLS, "cells", nullptr},
                                                   {request_t::OPERATION_NEAREST, "nearest", "nearest"},
                                                   {request_t::OPERATION_RAYS, "rays", "rays"},
                                                   {request_t::OPERATION_REGION, "region", "region"},
                                                   {request_t::OPERATION_PLANE, "plane", "plane"},
                                                   {request_t::OPERATION_FLOORPLAN, "floorplan", "floorplan"}}};

Refusal refuse(const Error& error) {
  return {reply_t::STATUS_BAD_REQUEST, error.message};
}

/// Runs a query and adds what it gives.
template <class Result, class... More>
std::optional<Refusal> add(reply_t& answer, const Expected<Result>& result, More... more) {
  if (!result) return refuse(result.error());
  add_to(answer, *result, more...);
  return std::nullopt;
}

std::optional<Refusal> add_cells(const MapSnapshot& snapshot, reply_t& answer, std::size_t max_reply_bytes) {
  if (snapshot.cell_count() > max_reply_bytes / sizeof(planemap_lcm::cell_t)) {
    return Refusal{reply_t::STATUS_TOO_LARGE,
                   fmt::format("the map's {} cells are more than {} bytes; ask for those of regions",
                               snapshot.cell_count(), max_reply_bytes)};
  }
  snapshot.for_each_cell([&](const CellView& cell) { answer.cells.push_back(to_wire(cell)); });
  return std::nullopt;
}

std::optional<Refusal> add_nearest(const SnapshotQueries& queries, const planemap_lcm::nearest_query_t& wire,
                                   const PlaneFilter& filter, reply_t& answer) {
  const auto points = to_queries(wire, filter);
  if (!points) return refuse(points.error());
  for (std::size_t i = 0; i < points->size(); ++i) {
    const auto near = queries.nearest((*points)[i]);
    if (!near) return refuse(of_point(i, near.error()));
    add_to(answer, *near, i);
  }
  return std::nullopt;
}

std::optional<Refusal> add_rays(const SnapshotQueries& queries, const planemap_lcm::rays_query_t& wire,
                                const PlaneFilter& filter, reply_t& answer) {
  const auto query = to_query(wire, filter);
  if (!query) return refuse(query.error());
  const auto hits = queries.cast(query->rays, query->options);
  if (!hits) return refuse(hits.error());
  add_to(answer, std::span<const RayHits>(*hits));
  return std::nullopt;
}

std::optional<Refusal> add_plane(const SnapshotQueries& queries, std::int64_t id, reply_t& answer) {
  if (id <= 0) return Refusal{reply_t::STATUS_BAD_REQUEST, fmt::format("id: must be greater than 0, is {}", id)};
  return add(answer, queries.plane(static_cast<PlaneId>(id)));
}

/// A filter that was not asked for would be passed over in silence.
bool says_anything(const planemap_lcm::filter_t& filter) {
  return filter.epoch != 0 || filter.min_area_m2 != 0.0 || filter.max_normal_deviation_rad != 0.0 ||
         filter.seen_since_utime != 0 || !filter.classes.empty();
}

}  // namespace

bool is_map_operation(std::int16_t operation) {
  return operation > request_t::OPERATION_STATUS && operation <= request_t::OPERATION_FLOORPLAN;
}

std::string known_operations() {
  std::string text;
  for (const Operation& operation : kOperations) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", operation.number, operation.name);
  }
  return text;
}

std::optional<Refusal> check_arguments(const Request& request) {
  const auto operation = std::find_if(kOperations.begin(), kOperations.end(),
                                      [&](const Operation& o) { return o.number == request.operation; });
  const auto wrong = [](std::string message) { return Refusal{reply_t::STATUS_BAD_REQUEST, std::move(message)}; };
  const request_t& arguments = request.arguments;
  const std::array<std::pair<std::string_view, std::size_t>, 5> lists = {{{"nearest", arguments.nearest.size()},
                                                                          {"rays", arguments.rays.size()},
                                                                          {"region", arguments.region.size()},
                                                                          {"plane", arguments.plane.size()},
                                                                          {"floorplan", arguments.floorplan.size()}}};
  for (const auto& [name, size] : lists) {
    const bool is_its_own = operation->query != nullptr && name == operation->query;
    const bool may_be_none = !is_its_own || request.operation == request_t::OPERATION_FLOORPLAN;
    const std::size_t most = is_its_own ? 1 : 0;
    if (size <= most && (size > 0 || may_be_none)) continue;
    return wrong(fmt::format("{}: operation {} ({}) takes {} there, there are {}", name, operation->number,
                             operation->name, most == 0 ? "none" : (may_be_none ? "one or none" : "one"), size));
  }
  const bool takes_filter = operation->query != nullptr && request.operation != request_t::OPERATION_PLANE;
  if (!takes_filter && says_anything(arguments.filter)) {
    return wrong(fmt::format("filter: operation {} ({}) takes none; a region without limits does", operation->number,
                             operation->name));
  }
  return std::nullopt;
}

std::optional<Refusal> answer_from(const SnapshotQueries& queries, const Request& request, reply_t& answer,
                                   std::size_t max_reply_bytes) {
  const request_t& arguments = request.arguments;
  const auto filter = to_filter(arguments.filter);
  if (!filter) return refuse(filter.error());
  switch (request.operation) {
    case request_t::OPERATION_SNAPSHOT:
      for (const DescribedPlane& plane : queries.planes()) add_to(answer, plane);
      return std::nullopt;
    case request_t::OPERATION_CELLS:
      return add_cells(queries.snapshot(), answer, max_reply_bytes);
    case request_t::OPERATION_NEAREST:
      return add_nearest(queries, arguments.nearest.front(), *filter, answer);
    case request_t::OPERATION_RAYS:
      return add_rays(queries, arguments.rays.front(), *filter, answer);
    case request_t::OPERATION_REGION: {
      const auto query = to_query(arguments.region.front(), *filter);
      if (!query) return refuse(query.error());
      const auto contents = queries.region(*query);
      return contents ? add(answer, contents) : refuse(of_region(contents.error(), kLcmRegionNames));
    }
    case request_t::OPERATION_PLANE:
      return add_plane(queries, arguments.plane.front().id, answer);
    default: {
      FloorplanQuery query;
      query.filter = *filter;
      if (!arguments.floorplan.empty()) query = to_query(arguments.floorplan.front(), *filter);
      return add(answer, queries.floorplan(query));
    }
  }
}

}  // namespace planemap::service

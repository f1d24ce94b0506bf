#include "serve/grpc/plane_map_service.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "codec/proto_answer_codec.hpp"
#include "codec/proto_question_codec.hpp"
#include "serve/argument_names.hpp"
#include "serve/grpc/map_pages.hpp"
#include "serve/grpc/pages.hpp"

namespace planemap::service {
namespace {

constexpr int kMaxCellPlanes = 10000;

grpc::Status invalid(const Error& error) {
  return {grpc::StatusCode::INVALID_ARGUMENT, error.message};
}

/// So many items between two looks whether somebody still waits.
constexpr std::size_t kItemsPerLook = 64;

bool has_gone(const grpc::CallbackServerContext& context, std::size_t item) {
  return item % kItemsPerLook == 0 && context.IsCancelled();
}

}  // namespace

grpc::Status checked_size(v1::GetFloorPlanResponse& plan) {
  const std::size_t bytes = plan.ByteSizeLong();
  if (bytes <= kMaxMessageBytes) return grpc::Status::OK;
  plan.Clear();
  return {grpc::StatusCode::RESOURCE_EXHAUSTED,
          fmt::format("the floor plan takes {} bytes (at most {}); ask with a filter", bytes, kMaxMessageBytes)};
}

PlaneMapService::PlaneMapService(CallDesk& desk, IndexKeeper& keeper, WatchHub& hub, std::string frame,
                                 StatusMaker status)
    : desk_(desk), keeper_(keeper), hub_(hub), frame_(std::move(frame)), status_(std::move(status)) {}

/// The index to answer with, or why there is none: the map is of another epoch than the one that is meant (0: any).
std::shared_ptr<const MapIndex> PlaneMapService::index_for(std::uint64_t epoch, grpc::Status& status,
                                                           const char* epoch_name) {
  auto index = keeper_.current();
  if (!index) {
    status = {grpc::StatusCode::UNAVAILABLE, "the map is not ready to be asked"};
  } else if (epoch != 0 && epoch != index->snapshot().epoch()) {
    status = {grpc::StatusCode::FAILED_PRECONDITION,
              fmt::format("{}: the map is of epoch {}, asked for is {}; its ids mean other planes", epoch_name,
                          index->snapshot().epoch(), epoch)};
    index = nullptr;
  }
  return index;
}

/// The newest index, or that of the map which a part of a batch names. @param request  outlives what is given
template <class BatchRequest>
PlaneMapService::Choose PlaneMapService::index_of_batch(const BatchRequest& request) {
  return [this, &request](grpc::Status& status) -> std::shared_ptr<const MapIndex> {
    const std::uint64_t epoch = request.filter().epoch();
    if (!request.has_map()) {
      auto newest = index_for(epoch, status);
      if (newest && request.more_follow()) keeper_.keep(newest);
      return newest;
    }
    const v1::MapVersion& map = request.map();
    if (epoch != 0 && epoch != map.epoch()) {
      status = {grpc::StatusCode::INVALID_ARGUMENT,
                fmt::format("filter.epoch: is {}, map.epoch is {}", epoch, map.epoch())};
      return nullptr;
    }
    auto index = keeper_.of_version(map.epoch(), map.revision(), map.utime());
    if (!index) {
      status = {grpc::StatusCode::ABORTED, fmt::format("map: epoch {} revision {} is not kept any more: ask all anew",
                                                       map.epoch(), map.revision())};
    }
    return index;
  };
}

grpc::ServerUnaryReactor* PlaneMapService::ask_map(grpc::CallbackServerContext* context, Choose choose, Ask ask) {
  return answer(desk_, context, Scope::kRead, [choose = std::move(choose), ask = std::move(ask)] {
    grpc::Status status;
    const auto index = choose(status);
    return index ? ask(*index) : status;
  });
}

grpc::ServerUnaryReactor* PlaneMapService::GetStatus(grpc::CallbackServerContext* context, const v1::GetStatusRequest*,
                                                     v1::GetStatusResponse* response) {
  return answer(desk_, context, Scope::kRead, [this, response] {
    *response = status_();
    return grpc::Status::OK;
  });
}

grpc::ServerUnaryReactor* PlaneMapService::GetPlane(grpc::CallbackServerContext* context,
                                                    const v1::GetPlaneRequest* request,
                                                    v1::GetPlaneResponse* response) {
  return ask_map(
      context, [this, request](grpc::Status& status) { return index_for(request->epoch(), status, "epoch"); },
      [request, response](const MapIndex& index) -> grpc::Status {
        const auto lookup = index.queries().plane(request->plane_id());
        if (!lookup) return {grpc::StatusCode::INVALID_ARGUMENT, "plane_" + lookup.error().message};
        if (lookup->fate == PlaneFate::kUnknown) {
          return {grpc::StatusCode::NOT_FOUND,
                  fmt::format("plane {} was never seen in the map of epoch {}, or went too long ago",
                              request->plane_id(), index.snapshot().epoch())};
        }
        *response = to_proto(*lookup);
        *response->mutable_map() = version_of(index.snapshot());
        if (response->has_plane()) cut_to_fit(*response->mutable_plane(), kMaxItemBytes / 2);
        return grpc::Status::OK;
      });
}

grpc::ServerUnaryReactor* PlaneMapService::GetFloorPlan(grpc::CallbackServerContext* context,
                                                        const v1::GetFloorPlanRequest* request,
                                                        v1::GetFloorPlanResponse* response) {
  const auto choose = [this, request](grpc::Status& status) { return index_for(request->filter().epoch(), status); };
  return ask_map(context, choose, [request, response](const MapIndex& index) -> grpc::Status {
    const auto query = to_query(*request);
    if (!query) return invalid(query.error());
    const auto plan = index.queries().floorplan(*query);
    if (!plan) {
      // What the map lacks is told under the plan's own name, what the request has wrong under the argument's.
      const bool is_lacking = plan.error().message.rfind("floorplan: ", 0) == 0;
      return {is_lacking ? grpc::StatusCode::FAILED_PRECONDITION : grpc::StatusCode::INVALID_ARGUMENT,
              plan.error().message};
    }
    *response = to_proto(*plan);
    *response->mutable_map() = version_of(index.snapshot());
    return checked_size(*response);
  });
}

grpc::ServerUnaryReactor* PlaneMapService::NearestPlanes(grpc::CallbackServerContext* context,
                                                         const v1::NearestPlanesRequest* request,
                                                         v1::NearestPlanesResponse* response) {
  return ask_map(context, index_of_batch(*request),
                 [context, request, response](const MapIndex& index) -> grpc::Status {
                   const auto queries = to_queries(*request);
                   if (!queries) return invalid(queries.error());
                   *response->mutable_map() = version_of(index.snapshot());
                   for (std::size_t i = 0; i < queries->size(); ++i) {
                     if (has_gone(*context, i)) return grpc::Status::CANCELLED;
                     const auto near = index.queries().nearest((*queries)[i]);
                     if (!near) return invalid(of_point(i, near.error()));
                     v1::NearPlanes& result = *response->add_results();
                     for (const NearPlane& plane : *near) *result.add_planes() = to_proto(plane);
                   }
                   return grpc::Status::OK;
                 });
}

grpc::ServerUnaryReactor* PlaneMapService::CastRays(grpc::CallbackServerContext* context,
                                                    const v1::CastRaysRequest* request,
                                                    v1::CastRaysResponse* response) {
  return ask_map(
      context, index_of_batch(*request), [context, request, response](const MapIndex& index) -> grpc::Status {
        const auto query = to_query(*request);
        if (!query) return invalid(query.error());
        *response->mutable_map() = version_of(index.snapshot());
        for (std::size_t i = 0; i < query->rays.size(); i += kItemsPerLook) {
          if (context->IsCancelled()) return grpc::Status::CANCELLED;
          const std::size_t count = std::min(kItemsPerLook, query->rays.size() - i);
          const auto hits = index.queries().cast(std::span(query->rays).subspan(i, count), query->options);
          // Rays are numbered from the batch's begin.
          if (!hits)
            return invalid(
                Error{i == 0 ? hits.error().message : fmt::format("from rays[{}] on: {}", i, hits.error().message)});
          for (const RayHits& hit : *hits) *response->add_hits() = to_proto(hit);
        }
        return grpc::Status::OK;
      });
}

grpc::ServerWriteReactor<v1::SnapshotPage>* PlaneMapService::GetSnapshot(grpc::CallbackServerContext* context,
                                                                         const v1::GetSnapshotRequest* request) {
  using Reactor = PageReactor<v1::SnapshotPage>;
  return Reactor::start(desk_, context, [this, request](grpc::Status& status) -> Reactor::Next {
    const auto index = index_for(request->filter().epoch(), status);
    if (!index) return {};
    const auto filter = to_filter(request->filter());
    auto match = filter ? index->queries().matching(*filter) : tl::make_unexpected(filter.error());
    if (!match) {
      status = invalid(match.error());
      return {};
    }
    return snapshot_pages(index, frame_, std::move(*match));
  });
}

grpc::ServerWriteReactor<v1::CellsPage>* PlaneMapService::GetCells(grpc::CallbackServerContext* context,
                                                                   const v1::GetCellsRequest* request) {
  using Reactor = PageReactor<v1::CellsPage>;
  return Reactor::start(desk_, context, [this, request](grpc::Status& status) -> Reactor::Next {
    const auto index = index_for(request->filter().epoch(), status);
    if (!index) return {};
    if (request->plane_ids_size() > kMaxCellPlanes) {
      status = {grpc::StatusCode::INVALID_ARGUMENT,
                fmt::format("plane_ids: {} are more than {}", request->plane_ids_size(), kMaxCellPlanes)};
      return {};
    }
    const auto filter = to_filter(request->filter());
    auto match = filter ? index->queries().matching(*filter) : tl::make_unexpected(filter.error());
    if (!match) {
      status = invalid(match.error());
      return {};
    }
    if (request->plane_ids_size() > 0) {
      std::vector<PlaneId> asked(request->plane_ids().begin(), request->plane_ids().end());
      std::sort(asked.begin(), asked.end());
      FilterMatch both;
      std::set_intersection(match->planes.begin(), match->planes.end(), asked.begin(), asked.end(),
                            std::back_inserter(both.planes));
      *match = std::move(both);
    }
    return cells_pages(index, frame_, std::move(*match));
  });
}

grpc::ServerWriteReactor<v1::RegionPage>* PlaneMapService::QueryRegion(grpc::CallbackServerContext* context,
                                                                       const v1::QueryRegionRequest* request) {
  using Reactor = PageReactor<v1::RegionPage>;
  return Reactor::start(desk_, context, [this, request](grpc::Status& status) -> Reactor::Next {
    const auto index = index_for(request->filter().epoch(), status);
    if (!index) return {};
    const auto query = to_query(*request);
    auto contents = query ? index->queries().region(*query) : tl::make_unexpected(query.error());
    if (!contents) {
      status = invalid(of_region(contents.error(), kGrpcRegionNames));
      return {};
    }
    return region_pages(index, std::move(*contents));
  });
}

grpc::ServerWriteReactor<v1::WatchEvent>* PlaneMapService::Watch(grpc::CallbackServerContext* context,
                                                                 const v1::WatchRequest* request) {
  return hub_.watch(context, *request);
}

}  // namespace planemap::service

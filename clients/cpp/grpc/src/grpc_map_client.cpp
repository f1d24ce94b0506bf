#include "planemap/client/grpc_map_client.hpp"

#include <optional>
#include <utility>

#include "ask_in_parts.hpp"
#include "deadline.hpp"
#include "grpc_channel.hpp"
#include "grpc_map_watch.hpp"
#include "map_stream.hpp"
#include "proto_answers.hpp"
#include "proto_questions.hpp"
#include "query_checks.hpp"

namespace planemap::client {
namespace {

using std::chrono::milliseconds;

// What a call may bring at most, as service/api says.
constexpr std::size_t kMostNearestPlanes = 5000;
constexpr std::size_t kMostRays = 2000;

template <class Request, class Response>
Expected<Response> call(GrpcChannel& channel, const Request& request, milliseconds timeout,
                        grpc::Status (v1::PlaneMap::Stub::*method)(grpc::ClientContext*, const Request&, Response*)) {
  return channel.call(channel.plane_map(), method, request, timeout);
}

/// A service that knows nothing of batches in several calls answers by its newest map: where that is another version
/// than the begin's, all begins anew.
Expected<MapVersion> one_version(const MapVersion& wanted, const MapVersion& got) {
  const bool is_same = wanted.epoch == 0 || (wanted.epoch == got.epoch && wanted.revision == got.revision);
  if (is_same) return got;
  return tl::make_unexpected(Error{Error::Kind::kGone, "the map has changed"});
}

}  // namespace

Expected<std::unique_ptr<GrpcMapClient>> GrpcMapClient::connect(const std::string& server,
                                                                const GrpcClientOptions& options) {
  const auto connection = GrpcConnection::open(server, options);
  if (!connection) return tl::make_unexpected(connection.error());
  return std::make_unique<GrpcMapClient>(*connection);
}

GrpcMapClient::GrpcMapClient(const GrpcConnection& connection) : channel_(connection.channel()) {}

GrpcMapClient::~GrpcMapClient() = default;

Expected<Status> GrpcMapClient::status(Timeout timeout) {
  const auto response = call(*channel_, v1::GetStatusRequest(), timeout, &v1::PlaneMap::Stub::GetStatus);
  if (!response) return tl::make_unexpected(response.error());
  Status status;
  if (!read(*response, status)) return malformed("the status");
  return status;
}

Expected<Map> GrpcMapClient::snapshot(Timeout timeout) {
  return read_snapshot(*channel_, timeout);
}

Expected<Map> GrpcMapClient::cells(Timeout timeout) {
  return read_cells(*channel_, timeout);
}

Expected<Map> GrpcMapClient::whole_map(Timeout timeout) {
  return read_whole_map(*channel_, timeout);
}

Expected<NearestAnswer> GrpcMapClient::nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                               Timeout timeout) {
  if (auto good = check_query(points, options); !good) return tl::make_unexpected(good.error());
  NearestAnswer answer;
  v1::MapVersion map;  // that answered the parts before
  const auto ask_part = [&](std::span<const QueryPoint> part, const MapVersion& version,
                            milliseconds left) -> Expected<MapVersion> {
    v1::NearestPlanesRequest request = nearest_message(part, options);
    request.set_more_follow(&part.back() != &points.back());
    if (version.epoch != 0) *request.mutable_map() = map;
    const auto response = call(*channel_, request, left, &v1::PlaneMap::Stub::NearestPlanes);
    if (!response) return tl::make_unexpected(response.error());
    map = response->map();
    bool sound = read(response->map(), answer.version) && response->results_size() == static_cast<int>(part.size());
    for (const v1::NearPlanes& result : response->results()) {
      sound &= read_all(result.planes(), answer.points.emplace_back());
    }
    if (!sound) return malformed("the planes near the points");
    return one_version(version, answer.version);
  };
  const std::size_t most = kMostNearestPlanes / static_cast<std::size_t>(options.count);
  const auto asked = ask_in_parts(
      points, most, timeout, [&] { answer = {}; }, ask_part);
  if (!asked) return tl::make_unexpected(asked.error());
  return answer;
}

Expected<CastAnswer> GrpcMapClient::cast(std::span<const Ray> rays, const CastOptions& options, Timeout timeout) {
  if (auto good = check_query(rays, options); !good) return tl::make_unexpected(good.error());
  CastAnswer answer;
  v1::MapVersion map;  // that answered the parts before
  const auto ask_part = [&](std::span<const Ray> part, const MapVersion& version,
                            milliseconds left) -> Expected<MapVersion> {
    v1::CastRaysRequest request = rays_message(part, options);
    request.set_more_follow(&part.back() != &rays.back());
    if (version.epoch != 0) *request.mutable_map() = map;
    const auto response = call(*channel_, request, left, &v1::PlaneMap::Stub::CastRays);
    if (!response) return tl::make_unexpected(response.error());
    map = response->map();
    const bool sound = read(response->map(), answer.version) &&
                       response->hits_size() == static_cast<int>(part.size()) &&
                       read_all(response->hits(), answer.rays);
    if (!sound) return malformed("what the rays hit");
    return one_version(version, answer.version);
  };
  const auto asked = ask_in_parts(
      rays, kMostRays, timeout, [&] { answer = {}; }, ask_part);
  if (!asked) return tl::make_unexpected(asked.error());
  return answer;
}

Expected<RegionAnswer> GrpcMapClient::region(const RegionQuery& query, Timeout timeout) {
  if (auto good = check_filter(query.filter); !good) return tl::make_unexpected(good.error());
  return read_region(*channel_, region_message(query), timeout);
}

Expected<PlaneAnswer> GrpcMapClient::plane(std::int64_t id, Timeout timeout) {
  if (auto good = check_plane_id(id); !good) return tl::make_unexpected(good.error());
  const Deadline deadline(timeout);
  v1::GetPlaneRequest request;
  request.set_plane_id(static_cast<std::uint64_t>(id));
  grpc::ClientContext context;
  channel_->prepare(context, timeout);
  v1::GetPlaneResponse response;
  PlaneAnswer answer;
  answer.asked = id;
  const grpc::Status status = channel_->plane_map().GetPlane(&context, request, &response);
  if (status.error_code() == grpc::StatusCode::NOT_FOUND) {
    return this->status(deadline.left()).map([&](const Status& now) {
      answer.version = {now.epoch, now.revision};
      return answer;
    });
  }
  if (!status.ok()) return tl::make_unexpected(channel_->error_of(status, timeout));
  if (!read(response, answer)) return malformed("what became of the plane");
  return answer;
}

Expected<FloorplanAnswer> GrpcMapClient::floorplan(const FloorplanQuery& query, Timeout timeout) {
  if (auto good = check_filter(query.filter); !good) return tl::make_unexpected(good.error());
  const auto response = call(*channel_, floorplan_message(query), timeout, &v1::PlaneMap::Stub::GetFloorPlan);
  if (!response) return tl::make_unexpected(response.error());
  FloorplanAnswer plan;
  if (!read(*response, plan)) return malformed("the floor plan");
  return plan;
}

std::unique_ptr<MapWatch> GrpcMapClient::watch() {
  return std::make_unique<GrpcMapWatch>(channel_);
}

}  // namespace planemap::client

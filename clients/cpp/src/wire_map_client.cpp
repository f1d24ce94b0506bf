#include "planemap/client/wire_map_client.hpp"

#include <utility>

#include "lcm/wire_queries.hpp"

namespace planemap::client {

WireMapClient::WireMapClient(std::unique_ptr<WireQueries> queries) : queries_(std::move(queries)) {}

WireMapClient::~WireMapClient() = default;

Expected<Status> WireMapClient::status(Timeout timeout) {
  return queries_->status(timeout);
}

Expected<Map> WireMapClient::snapshot(Timeout timeout) {
  return queries_->snapshot(timeout);
}

Expected<Map> WireMapClient::cells(Timeout timeout) {
  return queries_->cells(timeout);
}

Expected<Map> WireMapClient::whole_map(Timeout timeout) {
  return queries_->whole_map(timeout);
}

Expected<NearestAnswer> WireMapClient::nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                               Timeout timeout) {
  return queries_->nearest(points, options, timeout);
}

Expected<CastAnswer> WireMapClient::cast(std::span<const Ray> rays, const CastOptions& options, Timeout timeout) {
  return queries_->cast(rays, options, timeout);
}

Expected<RegionAnswer> WireMapClient::region(const RegionQuery& query, Timeout timeout) {
  return queries_->region(query, timeout);
}

Expected<PlaneAnswer> WireMapClient::plane(std::int64_t id, Timeout timeout) {
  return queries_->plane(id, timeout);
}

Expected<FloorplanAnswer> WireMapClient::floorplan(const FloorplanQuery& query, Timeout timeout) {
  return queries_->floorplan(query, timeout);
}

}  // namespace planemap::client

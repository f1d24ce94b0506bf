#pragma once

#include <memory>
#include <planemap/client/grpc_connection.hpp>
#include <planemap/client/map_client.hpp>
#include <span>
#include <string>

namespace planemap::client {

/// Asks a planemap service over gRPC (planemap.v1.PlaneMap). A call's timeout is its deadline: the service, too, gives
/// up then. Where nobody listens, calls but those of a watch fail at once.
class GrpcMapClient final : public MapClient {
 public:
  /// As GrpcConnection::open().
  static Expected<std::unique_ptr<GrpcMapClient>> connect(const std::string& server,
                                                          const GrpcClientOptions& options = {});
  explicit GrpcMapClient(const GrpcConnection& connection);
  ~GrpcMapClient() override;

  Expected<Status> status(Timeout timeout) override;
  Expected<Map> snapshot(Timeout timeout) override;
  Expected<Map> cells(Timeout timeout) override;
  /// Both are asked for at once; anew where the map changed just in between.
  Expected<Map> whole_map(Timeout timeout) override;
  /// More than 5,000 planes (points times count) or 2,000 rays go in several calls, and all of them anew where the map
  /// changes in between: of a map that is being made, ask so many at a time.
  Expected<NearestAnswer> nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                  Timeout timeout) override;
  Expected<CastAnswer> cast(std::span<const Ray> rays, const CastOptions& options, Timeout timeout) override;
  Expected<RegionAnswer> region(const RegionQuery& query, Timeout timeout) override;
  /// The version of an answer of fate kUnknown is that of the map just after.
  Expected<PlaneAnswer> plane(std::int64_t id, Timeout timeout) override;
  Expected<FloorplanAnswer> floorplan(const FloorplanQuery& query, Timeout timeout) override;
  /// By planemap.v1's Watch, and by snapshots where the service asks for that. Connects again whenever it is cut off.
  std::unique_ptr<MapWatch> watch() override;

 private:
  std::shared_ptr<GrpcChannel> channel_;
};

}  // namespace planemap::client

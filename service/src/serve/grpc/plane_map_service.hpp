#pragma once

#include <planemap/v1/planemap_service.grpc.pb.h>

#include <functional>
#include <string>

#include "serve/grpc/calls.hpp"
#include "serve/grpc/index_keeper.hpp"
#include "serve/grpc/watch_hub.hpp"

namespace planemap::service {

/// OK where a floor plan fits in one message; else it is emptied, and the status says what takes too much.
grpc::Status checked_size(v1::GetFloorPlanResponse& plan);

/// planemap.v1.PlaneMap on the last snapshot.
class PlaneMapService final : public v1::PlaneMap::CallbackService {
 public:
  using StatusMaker = std::function<v1::GetStatusResponse()>;

  /// @param frame   name of the world frame
  /// @param status  how the service is; called from several threads
  PlaneMapService(CallDesk& desk, IndexKeeper& keeper, WatchHub& hub, std::string frame, StatusMaker status);

  grpc::ServerUnaryReactor* GetStatus(grpc::CallbackServerContext* context, const v1::GetStatusRequest* request,
                                      v1::GetStatusResponse* response) override;
  grpc::ServerUnaryReactor* GetPlane(grpc::CallbackServerContext* context, const v1::GetPlaneRequest* request,
                                     v1::GetPlaneResponse* response) override;
  grpc::ServerUnaryReactor* GetFloorPlan(grpc::CallbackServerContext* context, const v1::GetFloorPlanRequest* request,
                                         v1::GetFloorPlanResponse* response) override;
  grpc::ServerUnaryReactor* NearestPlanes(grpc::CallbackServerContext* context, const v1::NearestPlanesRequest* request,
                                          v1::NearestPlanesResponse* response) override;
  grpc::ServerUnaryReactor* CastRays(grpc::CallbackServerContext* context, const v1::CastRaysRequest* request,
                                     v1::CastRaysResponse* response) override;
  grpc::ServerWriteReactor<v1::SnapshotPage>* GetSnapshot(grpc::CallbackServerContext* context,
                                                          const v1::GetSnapshotRequest* request) override;
  grpc::ServerWriteReactor<v1::CellsPage>* GetCells(grpc::CallbackServerContext* context,
                                                    const v1::GetCellsRequest* request) override;
  grpc::ServerWriteReactor<v1::RegionPage>* QueryRegion(grpc::CallbackServerContext* context,
                                                        const v1::QueryRegionRequest* request) override;
  grpc::ServerWriteReactor<v1::WatchEvent>* Watch(grpc::CallbackServerContext* context,
                                                  const v1::WatchRequest* request) override;

 private:
  using Ask = std::function<grpc::Status(const MapIndex&)>;
  using Choose = std::function<std::shared_ptr<const MapIndex>(grpc::Status&)>;
  grpc::ServerUnaryReactor* ask_map(grpc::CallbackServerContext* context, Choose choose, Ask ask);
  template <class BatchRequest>
  Choose index_of_batch(const BatchRequest& request);
  std::shared_ptr<const MapIndex> index_for(std::uint64_t epoch, grpc::Status& status,
                                            const char* epoch_name = "filter.epoch");

  CallDesk& desk_;
  IndexKeeper& keeper_;
  WatchHub& hub_;
  const std::string frame_;
  const StatusMaker status_;
};

}  // namespace planemap::service

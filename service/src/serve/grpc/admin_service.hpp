#pragma once

#include <planemap/v1/admin_service.grpc.pb.h>

#include "mapping/mapping_service.hpp"
#include "serve/grpc/calls.hpp"

namespace planemap::service {

/// planemap.v1.Admin.
class AdminService final : public v1::Admin::CallbackService {
 public:
  AdminService(CallDesk& desk, MappingService& mapping) : desk_(desk), mapping_(mapping) {}

  grpc::ServerUnaryReactor* Save(grpc::CallbackServerContext* context, const v1::SaveRequest* request,
                                 v1::SaveResponse* response) override;
  grpc::ServerUnaryReactor* Reset(grpc::CallbackServerContext* context, const v1::ResetRequest* request,
                                  v1::ResetResponse* response) override;
  grpc::ServerUnaryReactor* Pause(grpc::CallbackServerContext* context, const v1::PauseRequest* request,
                                  v1::PauseResponse* response) override;
  grpc::ServerUnaryReactor* Resume(grpc::CallbackServerContext* context, const v1::ResumeRequest* request,
                                   v1::ResumeResponse* response) override;

 private:
  CallDesk& desk_;
  MappingService& mapping_;
};

}  // namespace planemap::service

#include "serve/grpc/admin_service.hpp"

#include <spdlog/spdlog.h>

#include <chrono>

namespace planemap::service {
namespace {

/// The scan at hand is mapped first.
constexpr std::chrono::seconds kResetTimeout(5);

/// A slow disk takes a whole map.
constexpr std::chrono::seconds kSaveTimeout(20);

}  // namespace

grpc::ServerUnaryReactor* AdminService::Save(grpc::CallbackServerContext* context, const v1::SaveRequest*,
                                             v1::SaveResponse*) {
  return answer(desk_, context, Scope::kAdmin, [this, context]() -> grpc::Status {
    spdlog::info("gRPC: {} asks for the map to be saved", context->peer());
    if (const auto saved = mapping_.save(kSaveTimeout); !saved) {
      return {grpc::StatusCode::FAILED_PRECONDITION, saved.error().message};
    }
    return grpc::Status::OK;
  });
}

grpc::ServerUnaryReactor* AdminService::Reset(grpc::CallbackServerContext* context, const v1::ResetRequest*,
                                              v1::ResetResponse* response) {
  return answer(desk_, context, Scope::kAdmin, [this, context, response]() -> grpc::Status {
    spdlog::info("gRPC: {} asks for a new map", context->peer());
    const auto epoch = mapping_.reset(kResetTimeout);
    if (!epoch) {
      // Not UNAVAILABLE, of which clients make "cannot be reached", and which is asked again.
      return {grpc::StatusCode::FAILED_PRECONDITION,
              "the mapper is busy with a scan; the new map begins once that is mapped"};
    }
    response->set_epoch(*epoch);
    if (!mapping_.has_keeper()) return grpc::Status::OK;
    if (const auto saved = mapping_.save(kSaveTimeout); !saved) {  // else a crash would bring the old map back
      return {grpc::StatusCode::FAILED_PRECONDITION,
              "a new map has begun, but its file still holds the old one, which is tried on: " + saved.error().message};
    }
    return grpc::Status::OK;
  });
}

grpc::ServerUnaryReactor* AdminService::Pause(grpc::CallbackServerContext* context, const v1::PauseRequest*,
                                              v1::PauseResponse*) {
  return answer(desk_, context, Scope::kAdmin, [this, context] {
    spdlog::info("gRPC: {} pauses the mapping", context->peer());
    mapping_.pause();
    return grpc::Status::OK;
  });
}

grpc::ServerUnaryReactor* AdminService::Resume(grpc::CallbackServerContext* context, const v1::ResumeRequest*,
                                               v1::ResumeResponse*) {
  return answer(desk_, context, Scope::kAdmin, [this, context] {
    spdlog::info("gRPC: {} resumes the mapping", context->peer());
    mapping_.resume();
    return grpc::Status::OK;
  });
}

}  // namespace planemap::service

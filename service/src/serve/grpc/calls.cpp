#include "serve/grpc/calls.hpp"

#include <spdlog/spdlog.h>

#include <string_view>

namespace planemap::service {
namespace {

/// As the reference of gRPC writes them.
const char* name_of(grpc::StatusCode code) {
  switch (code) {
    case grpc::StatusCode::CANCELLED:
      return "cancelled";
    case grpc::StatusCode::INVALID_ARGUMENT:
      return "invalid_argument";
    case grpc::StatusCode::NOT_FOUND:
      return "not_found";
    case grpc::StatusCode::UNAUTHENTICATED:
      return "unauthenticated";
    case grpc::StatusCode::PERMISSION_DENIED:
      return "permission_denied";
    case grpc::StatusCode::FAILED_PRECONDITION:
      return "failed_precondition";
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
      return "resource_exhausted";
    case grpc::StatusCode::UNIMPLEMENTED:
      return "unimplemented";
    case grpc::StatusCode::UNAVAILABLE:
      return "unavailable";
    case grpc::StatusCode::ABORTED:
      return "aborted";
    default:
      return "internal";
  }
}

}  // namespace

grpc::Status CallDesk::admit(const grpc::CallbackServerContext& context, Scope needed) {
  const auto& metadata = context.client_metadata();
  const auto found = metadata.find("authorization");
  const std::string_view authorization =
      found == metadata.end() ? std::string_view() : std::string_view(found->second.data(), found->second.size());
  const Verdict verdict = guard.check(needed, authorization, context.peer());
  switch (verdict.denial) {
    case Denial::kNone:
      return grpc::Status::OK;
    case Denial::kUnauthenticated:
      return {grpc::StatusCode::UNAUTHENTICATED, verdict.message};
    case Denial::kPermissionDenied:
      break;
  }
  return {grpc::StatusCode::PERMISSION_DENIED, verdict.message};
}

grpc::Status CallDesk::enter_stream() {
  if (++streams <= max_streams) return grpc::Status::OK;
  --streams;
  return {grpc::StatusCode::RESOURCE_EXHAUSTED,
          std::to_string(max_streams) + " watchers and answers in pages are served already (grpc.max_streams)"};
}

grpc::Status CallDesk::counted(grpc::Status status) {
  counters.add(status.ok() ? "grpc.calls.ok" : std::string("grpc.calls.failed.") + name_of(status.error_code()));
  return status;
}

grpc::Status no_room(const WorkerPool& pool) {
  return {grpc::StatusCode::RESOURCE_EXHAUSTED,
          std::to_string(pool.capacity()) + " calls wait already (grpc.max_waiting_calls); ask again later"};
}

grpc::Status internal_error(const std::exception& cause) {
  spdlog::error("a call over gRPC could not be answered: {}", cause.what());
  return {grpc::StatusCode::INTERNAL, std::string("the service could not answer: ") + cause.what()};
}

grpc::ServerUnaryReactor* answer(CallDesk& desk, grpc::CallbackServerContext* context, Scope needed,
                                 std::function<grpc::Status()> work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  grpc::Status status = desk.admit(*context, needed);
  if (!status.ok()) {
    reactor->Finish(desk.counted(std::move(status)));
    return reactor;
  }
  const bool has_room = desk.pool.try_post([&desk, context, reactor, work = std::move(work)] {
    grpc::Status result = grpc::Status::CANCELLED;  // nobody waits any more, by cancellation or deadline
    try {
      if (!context->IsCancelled()) result = work();
    } catch (const std::exception& e) {
      result = internal_error(e);
    }
    reactor->Finish(desk.counted(std::move(result)));
  });
  if (!has_room) {
    reactor->Finish(desk.counted(no_room(desk.pool)));
  }
  return reactor;
}

}  // namespace planemap::service

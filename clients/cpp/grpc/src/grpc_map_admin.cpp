#include "planemap/client/grpc_map_admin.hpp"

#include "grpc_channel.hpp"

namespace planemap::client {
namespace {

template <class Request, class Response>
Expected<Response> call(GrpcChannel& channel, std::chrono::milliseconds timeout,
                        grpc::Status (v1::Admin::Stub::*method)(grpc::ClientContext*, const Request&, Response*)) {
  return channel.call(channel.admin(), method, Request(), timeout);
}

constexpr auto kNothing = [](const auto&) {};

}  // namespace

GrpcMapAdmin::GrpcMapAdmin(const GrpcConnection& connection) : channel_(connection.channel()) {}

Expected<void> GrpcMapAdmin::pause(Timeout timeout) {
  return call(*channel_, timeout, &v1::Admin::Stub::Pause).map(kNothing);
}

Expected<void> GrpcMapAdmin::resume(Timeout timeout) {
  return call(*channel_, timeout, &v1::Admin::Stub::Resume).map(kNothing);
}

Expected<std::int64_t> GrpcMapAdmin::reset(Timeout timeout) {
  return call(*channel_, timeout, &v1::Admin::Stub::Reset).map([](const v1::ResetResponse& response) {
    return static_cast<std::int64_t>(response.epoch());
  });
}

Expected<void> GrpcMapAdmin::save(Timeout timeout) {
  return call(*channel_, timeout, &v1::Admin::Stub::Save).map(kNothing);
}

}  // namespace planemap::client

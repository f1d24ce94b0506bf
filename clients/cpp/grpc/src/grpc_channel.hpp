#pragma once

#include <grpcpp/grpcpp.h>
#include <planemap/v1/admin_service.grpc.pb.h>
#include <planemap/v1/planemap_service.grpc.pb.h>

#include <chrono>
#include <memory>
#include <planemap/client/grpc_connection.hpp>
#include <string>

#include "server_address.hpp"

namespace planemap::client {

/// The stubs of a server, and what its errors mean.
class GrpcChannel {
 public:
  GrpcChannel(ServerAddress address, GrpcClientOptions options);

  v1::PlaneMap::Stub& plane_map() { return *plane_map_; }
  v1::Admin::Stub& admin() { return *admin_; }
  const GrpcClientOptions& options() const { return options_; }
  /// HOST:PORT
  std::string server() const { return address_.text(); }

  /// The same way to the same server, over a new connection. One that was cut off connects again by itself, but not
  /// before it has waited, and only while a call is polled: a watch took up to eight seconds.
  std::shared_ptr<GrpcChannel> connect_again() const;

  /// Puts what each call brings into a context: token and deadline.
  void prepare(grpc::ClientContext& context, std::chrono::milliseconds timeout) const;
  /// The same for a call without end.
  void prepare(grpc::ClientContext& context) const;

  /// Makes a call that brings one message.
  template <class Stub, class Request, class Response>
  Expected<Response> call(Stub& stub, grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                          const Request& request, std::chrono::milliseconds timeout) const {
    grpc::ClientContext context;
    prepare(context, timeout);
    Response response;
    const grpc::Status status = (stub.*method)(&context, request, &response);
    if (!status.ok()) return tl::make_unexpected(error_of(status, timeout));
    return response;
  }

  /// Why a call failed, in words that say what to do. @pre !status.ok()
  Error error_of(const grpc::Status& status, std::chrono::milliseconds timeout) const;

 private:
  const ServerAddress address_;
  const GrpcClientOptions options_;
  std::unique_ptr<v1::PlaneMap::Stub> plane_map_;
  std::unique_ptr<v1::Admin::Stub> admin_;
};

}  // namespace planemap::client

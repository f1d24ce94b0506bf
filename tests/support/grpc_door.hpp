#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "serve/grpc/grpc_server.hpp"
#include "service.hpp"

namespace planemap {

/// The gRPC server of a service, on a free port of the loopback; answers come from the newest map.
class GrpcDoor {
 public:
  /// @param listen  empty: a free port
  GrpcDoor(service::Service& service, service::ServiceConfig config, const std::string& listen = {})
      : service_(service) {
    config.grpc.listen = listen.empty() ? "127.0.0.1:0" : listen;
    config.grpc.index_age_s = 0.0;
    config.grpc.watch_period_s = 0.01;
    auto started =
        service::GrpcServer::start(config, service.mapping(), service.status_board(), service.counter_board());
    if (!started) throw std::runtime_error(started.error().message);
    server_ = std::move(*started);
    service_.set_snapshot_listener([this] { server_->wake(); });
  }
  ~GrpcDoor() {
    service_.set_snapshot_listener({});
    server_->stop();
  }
  GrpcDoor(const GrpcDoor&) = delete;
  GrpcDoor& operator=(const GrpcDoor&) = delete;

  std::string address() const { return server_->address(); }

 private:
  service::Service& service_;
  std::unique_ptr<service::GrpcServer> server_;
};

}  // namespace planemap

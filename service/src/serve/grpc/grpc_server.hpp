#pragma once

#include <cstdint>
#include <memory>
#include <planemap/expected.hpp>
#include <string>

#include "common/counters.hpp"
#include "config/service_config.hpp"
#include "mapping/mapping_service.hpp"
#include "serve/status_board.hpp"

namespace planemap::service {

/// planemap.v1 over gRPC, with health (grpc.health.v1) and reflection. Answers come from the newest snapshot, on
/// threads of its own; the mapper never waits for it. Health is SERVING, overall ("") and for planemap.v1.PlaneMap and
/// planemap.v1.Admin, from start() until stop(), unless set_serving() says otherwise.
class GrpcServer {
 public:
  /// Listens and serves. All that is handed in must outlive the server. The error says which setting or file cannot be
  /// used and why: a certificate or key, a token file, an address that others use.
  /// @pre config.grpc.listen is not empty, and config has been checked
  static Expected<std::unique_ptr<GrpcServer>> start(const ServiceConfig& config, MappingService& mapping,
                                                     StatusBoard board, Counters& counters);
  ~GrpcServer();
  GrpcServer(const GrpcServer&) = delete;
  GrpcServer& operator=(const GrpcServer&) = delete;

  std::uint16_t port() const;
  /// HOST:PORT as clients on this machine would write it.
  std::string address() const;
  /// Health says SERVING, or NOT_SERVING; from any thread, until stop().
  void set_serving(bool is_serving);
  /// There is a new snapshot. Returns at once; from any thread.
  void wake();
  /// Says NOT_SERVING, ends watches, lets the other calls end within a second, closes. The destructor does it, too.
  void stop();

 private:
  class Impl;
  explicit GrpcServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::service

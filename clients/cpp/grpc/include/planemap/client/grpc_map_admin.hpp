#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <planemap/client/grpc_connection.hpp>

namespace planemap::client {

/// Changes what a service does (planemap.v1.Admin). Needs a token of scope admin; of a service without tokens, to be on
/// its machine.
class GrpcMapAdmin {
 public:
  using Timeout = std::chrono::milliseconds;

  explicit GrpcMapAdmin(const GrpcConnection& connection);

  /// Scans are dropped until resume(); the map stays and can be asked. Pausing twice is fine.
  Expected<void> pause(Timeout timeout);
  /// Scans are mapped again. Resuming what is not paused is fine.
  Expected<void> resume(Timeout timeout);
  /// Begins a new, empty map.
  /// @return its epoch
  Expected<std::int64_t> reset(Timeout timeout);
  /// Writes the map to the service's store.
  Expected<void> save(Timeout timeout);

 private:
  std::shared_ptr<GrpcChannel> channel_;
};

}  // namespace planemap::client

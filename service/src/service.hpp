#pragma once

#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <mutex>
#include <planemap/expected.hpp>
#include <planemap/query/snapshot_queries.hpp>
#include <planemap/snapshot.hpp>
#include <planemap_lcm/status_t.hpp>
#include <stop_token>
#include <string>

#include "common/counters.hpp"
#include "config/service_config.hpp"
#include "ingest/scan_intake.hpp"
#include "mapping/mapping_service.hpp"
#include "serve/health.hpp"
#include "serve/lcm/lcm_server.hpp"
#include "serve/plane_book.hpp"

namespace planemap::service {

/// The whole service on one bus: LCM thread -> intake -> queue -> mapper thread -> snapshot -> publishing thread.
class Service {
 public:
  /// Subscribes and starts. The bus is handed in, so tests pass "memq://"; it must outlive the service, and nobody may
  /// handle it any more once the service is gone: its subscriptions stay, as LCM cannot end them safely.
  /// @param epoch  names the life of a map that begins, below 2^53
  /// @param initial  map to go on with, in its own epoch; nullptr: an empty one
  /// @throws std::runtime_error if the bus lets it subscribe to nothing, or the initial map cannot be gone on with
  Service(const ServiceConfig& config, lcm::LCM& bus, std::uint64_t epoch, const MapSnapshot* initial = nullptr);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Handles what the bus brings until the stop is requested; on the calling thread.
  void run(const std::stop_token& stop);
  /// One step of run(): at most one message.
  /// @return as lcm::LCM::handleTimeout: > 0 a message was handled, 0 none came in time, < 0 the bus failed
  int handle(int timeout_ms);
  /// Ends the threads. The destructor does it, too.
  void stop();

  /// Told of each new snapshot on the mapper's thread, beside the server on the bus; must return at once. Empty: nobody
  /// more is told; once this has returned, the one before is not called any more. From any thread.
  void set_snapshot_listener(std::function<void()> listener);

  // What another server than the one on the bus is made of; they live as long as the service.
  MappingService& mapping() { return mapping_; }
  Counters& counter_board() { return counters_; }
  PlaneBook& plane_book() { return book_; }
  Health& health() { return health_; }
  StatusBoard status_board() { return {intake_, mapping_, counters_}; }

  std::shared_ptr<const MapSnapshot> snapshot() const { return mapping_.snapshot(); }
  /// The newest snapshot with boundaries, classes and the index for queries; from any thread.
  std::shared_ptr<const SnapshotQueries> queries() { return book_.open(snapshot()); }
  /// How the service is; from any thread.
  planemap_lcm::status_t status() { return server_.status(); }
  CounterValues counters() const { return counters_.values(); }

 private:
  void subscribe(const std::string& channel);
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) noexcept;

  void on_snapshot();

  std::string request_channel_;
  lcm::LCM& bus_;
  Counters counters_;
  std::mutex listener_mutex_;
  std::function<void()> snapshot_listener_;
  MappingService mapping_;
  Health health_;
  ScanIntake intake_;
  PlaneBook book_;
  LcmServer server_;
};

/// Opens a bus, or says what is missing and how to mend it.
Expected<std::unique_ptr<lcm::LCM>> open_bus(const std::string& url);

}  // namespace planemap::service

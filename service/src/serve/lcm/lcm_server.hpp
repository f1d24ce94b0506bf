#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <mutex>
#include <span>
#include <string>
#include <thread>

#include "codec/request_codec.hpp"
#include "common/counters.hpp"
#include "common/repeat_guard.hpp"
#include "config/service_config.hpp"
#include "mapping/mapping_service.hpp"
#include "serve/lcm/delta_maker.hpp"
#include "serve/lcm/outbox.hpp"
#include "serve/lcm/request_answerer.hpp"
#include "serve/plane_book.hpp"
#include "serve/status_board.hpp"

namespace planemap::service {

/// Everything that goes out over LCM: status, deltas, replies; all from one thread of its own, as LCM's providers ask
/// for.
class LcmServer {
 public:
  LcmServer(const ServiceConfig& config, lcm::LCM& bus, const MappingService& mapping, StatusBoard board,
            Counters& counters);
  ~LcmServer();
  LcmServer(const LcmServer&) = delete;
  LcmServer& operator=(const LcmServer&) = delete;

  /// A message on the request channel, on LCM's thread: it is checked and queued, never answered here.
  void on_request(std::span<const std::uint8_t> message);
  /// There is a new snapshot. Returns at once; from any thread.
  void wake();
  /// Ends the thread. Called by the destructor, too.
  void stop();

 private:
  void run(const std::stop_token& stop);
  double next_due_s() const;
  bool has_delta() const;
  void take_requests();
  void publish_due(double now_s);
  void publish(const std::string& channel, const Page& bytes);
  void reject(const std::string& reason, const std::string& message);

  PublishConfig config_;
  lcm::LCM& bus_;
  const MappingService& mapping_;
  StatusBoard board_;
  Counters& counters_;

  // Of the publishing thread alone.
  PlaneBook book_;
  DeltaMaker deltas_;
  RequestAnswerer answerer_;
  Outbox outbox_;
  RepeatGuard publish_repeats_;
  double status_due_s_ = 0.0;
  double log_due_s_ = 0.0;
  double delta_due_s_ = 0.0;
  std::uint64_t told_epoch_ = 0;
  std::uint64_t told_revision_ = 0;

  RepeatGuard request_repeats_;  ///< of LCM's thread alone

  std::mutex mutex_;  ///< of what follows
  std::condition_variable_any woken_;
  bool is_woken_ = false;
  std::deque<Request> requests_;

  std::jthread thread_;  ///< last: ends before what it uses
};

}  // namespace planemap::service

#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <mutex>
#include <planemap_lcm/status_t.hpp>
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
#include "serve/lcm/plane_cloud_maker.hpp"
#include "serve/lcm/request_answerer.hpp"
#include "serve/plane_book.hpp"
#include "serve/status_board.hpp"

namespace planemap::service {

/// Everything that goes out over LCM: status, deltas, clouds of planes, replies; all from one thread of its own, as
/// LCM's providers ask for. Answers are worked out on another one: a floor plan of a large building takes seconds, in
/// which status and deltas go on.
class LcmServer {
 public:
  /// @param book  shared with whoever else answers; outlives the server
  LcmServer(const ServiceConfig& config, lcm::LCM& bus, const MappingService& mapping, PlaneBook& book,
            StatusBoard board, Counters& counters);
  ~LcmServer();
  LcmServer(const LcmServer&) = delete;
  LcmServer& operator=(const LcmServer&) = delete;

  /// A message on the request channel, on LCM's thread: it is checked and queued, never answered here.
  void on_request(std::span<const std::uint8_t> message);
  /// There is a new snapshot. Returns at once; from any thread.
  void wake();
  /// The status as it would be told now; from any thread.
  planemap_lcm::status_t status();
  /// Ends the threads. Called by the destructor, too.
  void stop();

 private:
  void run(const std::stop_token& stop);
  void run_answers(const std::stop_token& stop);
  void answer(const Request& request);
  double next_due_s() const;
  bool has_delta() const;
  void take_answers();
  void publish_due(double now_s);
  void publish(const std::string& channel, const Page& bytes);
  void reject(const std::string& reason, const std::string& message);

  PublishConfig config_;
  lcm::LCM& bus_;
  const MappingService& mapping_;
  std::mutex board_mutex_;
  StatusBoard board_;
  Counters& counters_;
  RequestAnswerer answerer_;  ///< of the answering thread alone

  // Of the publishing thread alone.
  DeltaMaker deltas_;
  PlaneCloudMaker clouds_;
  Outbox outbox_;
  RepeatGuard publish_repeats_;
  double status_due_s_ = 0.0;
  double log_due_s_ = 0.0;
  double delta_due_s_ = 0.0;
  double cloud_due_s_ = 0.0;
  std::uint64_t told_epoch_ = 0;
  std::uint64_t told_revision_ = 0;

  RepeatGuard request_repeats_;  ///< of LCM's thread alone

  std::mutex mutex_;  ///< of what follows
  std::condition_variable_any woken_;
  bool is_woken_ = false;
  std::condition_variable_any work_;  ///< there is a request, or room for its answer
  std::deque<Request> requests_;
  std::deque<Reply> answers_;  ///< on their way to the outbox
  std::size_t jobs_ = 0;       ///< in the outbox

  std::jthread answering_;  ///< last, these two: they end before what they use
  std::jthread publishing_;
};

}  // namespace planemap::service

#pragma once

#include <grpcpp/grpcpp.h>
#include <planemap/v1/map.pb.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>

#include "serve/grpc/delta_pages.hpp"
#include "serve/grpc/map_index.hpp"

namespace planemap::service {

class WatchHub;

/// One call of Watch; deletes itself when the call is over. Writes one event at a time; what happens meanwhile only
/// replaces the index that it goes to next.
class Watcher : public grpc::ServerWriteReactor<v1::WatchEvent> {
 public:
  Watcher(WatchHub& hub, const WatchPosition& position, double heartbeat_s);

  /// Brings it to an index, once what is on its way is written.
  void go_to(std::shared_ptr<const MapIndex> index);
  /// Sends a heartbeat if one is due. @return when the next one is, the host's steady clock, seconds
  double beat(double now_s);
  /// Ends the call, once what is on its way is written.
  void end(grpc::Status status);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  void step();
  const v1::WatchEvent* next_event();

  WatchHub& hub_;
  const double heartbeat_s_;

  std::mutex mutex_;  ///< of what follows; not held while gRPC is called
  WatchPosition position_;
  std::shared_ptr<const MapIndex> target_;  ///< the newest index
  WatchEvents events_;                      ///< on their way; nullptr: none are
  std::size_t next_ = 0;                    ///< of events_
  double written_at_s_;                     ///< when the last event went out
  bool wants_heartbeat_ = false;
  bool is_writing_ = false;
  bool is_finished_ = false;
  std::optional<grpc::Status> end_;  ///< with which the call is to end
};

}  // namespace planemap::service

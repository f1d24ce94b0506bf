#pragma once

#include <grpcpp/grpcpp.h>
#include <planemap/v1/map.pb.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "serve/grpc/calls.hpp"
#include "serve/grpc/delta_pages.hpp"
#include "serve/grpc/index_keeper.hpp"

namespace planemap::service {

class Watcher;

/// All calls of Watch. Each watcher has one state that it is to be brought to, the newest index, and no queue: one that
/// reads slowly gets the changes of many revisions in one delta. A thread of its own tells them of new indexes and
/// sends heartbeats.
class WatchHub {
 public:
  /// @param heartbeat_s  of watchers that ask for no other
  WatchHub(CallDesk& desk, double heartbeat_s);
  ~WatchHub();
  WatchHub(const WatchHub&) = delete;
  WatchHub& operator=(const WatchHub&) = delete;

  /// Before the first watch(); must outlive the hub's calls.
  void set_keeper(IndexKeeper& keeper) { keeper_ = &keeper; }
  grpc::ServerWriteReactor<v1::WatchEvent>* watch(grpc::CallbackServerContext* context,
                                                  const v1::WatchRequest& request);
  /// There is a new index. Returns at once.
  void on_index(std::shared_ptr<const MapIndex> index);
  /// Ends all calls, and lets no more in. The destructor does it, too.
  void stop();

 private:
  friend class Watcher;
  grpc::Status check(const v1::WatchRequest& request) const;
  void add(Watcher& watcher);
  void remove(Watcher& watcher);
  void run(const std::stop_token& stop);

  CallDesk& desk_;
  const double heartbeat_s_;
  IndexKeeper* keeper_ = nullptr;
  DeltaPages pages_;

  std::mutex mutex_;  ///< of what follows; taken before a watcher's own
  std::condition_variable_any woken_;
  std::shared_ptr<const MapIndex> index_;
  bool has_news_ = false;
  bool is_stopped_ = false;
  std::set<Watcher*> watchers_;

  std::jthread thread_;  ///< last: ends before what it uses
};

}  // namespace planemap::service

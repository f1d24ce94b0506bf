#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <planemap/client/map_watch.hpp>
#include <string>

#include "grpc_channel.hpp"
#include "map_mirror.hpp"
#include "watch_stream.hpp"

namespace planemap::client {

/// Mirrors a map by the events of Watch. A stream that ends is opened anew with what the mirror has; where the service
/// cannot carry that on it says so, and the whole map is asked for.
class GrpcMapWatch final : public MapWatch {
 public:
  explicit GrpcMapWatch(std::shared_ptr<GrpcChannel> channel);

  Expected<MapChange> next(std::chrono::milliseconds timeout) override;
  const Map& map() const override { return mirror_.map(); }

 private:
  using Clock = WatchStream::Clock;

  /// Nothing: there is nothing to tell of yet.
  using News = Expected<std::optional<MapChange>>;

  News wait_for_news(Clock::time_point until, std::chrono::milliseconds snapshot_timeout);
  News take(const v1::WatchEvent& event, std::chrono::milliseconds snapshot_timeout);
  News take_delta(const v1::WatchEvent& event);
  News take_snapshot(std::chrono::milliseconds timeout);
  News take_end(const grpc::Status& status);
  void open_again_later();
  Error silence(std::chrono::milliseconds time) const;

  std::shared_ptr<GrpcChannel> channel_;  ///< the client's; once cut off, one of its own
  std::unique_ptr<WatchStream> stream_;   ///< nullptr: there is none, or it has ended
  Clock::time_point open_at_;
  Clock::time_point heard_at_;     ///< of the service
  Clock::time_point listened_at_;  ///< when next() last looked
  std::string cut_off_;            ///< why the last stream ended; empty once it is heard of the service again
  std::optional<Delta> coming_;    ///< the pages so far of a delta
  std::uint32_t pages_ = 0;        ///< of it
  bool needs_snapshot_ = false;
  MapMirror mirror_;
};

}  // namespace planemap::client

#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <planemap/client/map_watch.hpp>
#include <planemap/client/query_types.hpp>
#include <string>

#include "lcm/delta_collector.hpp"
#include "lcm/lcm_requester.hpp"
#include "map_mirror.hpp"

namespace planemap::client {

/// Mirrors a map by the deltas that the service publishes. The status, once a second, says which revision there is:
/// what does not come in time was lost, and the whole map is asked for.
class LcmMapWatch final : public MapWatch {
 public:
  explicit LcmMapWatch(LcmRequester& requester);
  ~LcmMapWatch() override;

  Expected<MapChange> next(std::chrono::milliseconds timeout) override;
  const Map& map() const override { return mirror_.map(); }

 private:
  using Clock = std::chrono::steady_clock;

  void on_delta(const lcm::ReceiveBuffer* buffer, const std::string& channel) noexcept;
  void on_status(const lcm::ReceiveBuffer* buffer, const std::string& channel) noexcept;
  void expect(MapVersion version, Clock::time_point until);
  std::optional<MapChange> change_by_delta();
  Expected<MapChange> change_by_snapshot(std::chrono::milliseconds timeout);
  void forget_what_is_known();
  bool wait_until(Clock::time_point time);

  /// A revision that is known to be there, and when it is taken for lost.
  struct Due {
    MapVersion version;
    Clock::time_point until;
  };

  LcmRequester& requester_;
  lcm::Subscription* deltas_ = nullptr;
  lcm::Subscription* statuses_ = nullptr;
  DeltaCollector collector_;
  std::deque<Delta> waiting_;  ///< whole ones that are not applied yet
  MapMirror mirror_;
  std::optional<Due> due_;
  Clock::time_point heard_at_;
};

}  // namespace planemap::client

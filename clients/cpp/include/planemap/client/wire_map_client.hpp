#pragma once

#include <planemap/client/map_client.hpp>
#include <span>
#include <vector>

namespace planemap_lcm {
class reply_t;
class request_t;
}  // namespace planemap_lcm

namespace planemap::client {

/// What clients have in common that put their questions as planemap_lcm.request_t, whoever answers them.
class WireMapClient : public MapClient {
 public:
  Expected<Status> status(Timeout timeout) override;
  Expected<Map> snapshot(Timeout timeout) final;
  Expected<Map> cells(Timeout timeout) final;
  Expected<Map> whole_map(Timeout timeout) final;
  Expected<NearestAnswer> nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                  Timeout timeout) final;
  Expected<CastAnswer> cast(std::span<const Ray> rays, const CastOptions& options, Timeout timeout) final;
  Expected<RegionAnswer> region(const RegionQuery& query, Timeout timeout) final;
  Expected<PlaneAnswer> plane(std::int64_t id, Timeout timeout) final;
  Expected<FloorplanAnswer> floorplan(const FloorplanQuery& query, Timeout timeout) final;

 private:
  /// Gives all pages of the answer to a request, by number. Where the request names the epoch and revision of an
  /// earlier answer, the answer is of these, or an error (kGone).
  virtual Expected<std::vector<planemap_lcm::reply_t>> ask(const planemap_lcm::request_t& request, Timeout timeout) = 0;

  template <class Add>
  Expected<MapVersion> ask_part(planemap_lcm::request_t request, const MapVersion& version, Timeout timeout,
                                const Add& add);
};

}  // namespace planemap::client

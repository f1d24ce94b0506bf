#pragma once

#include <chrono>
#include <functional>
#include <planemap/client/map_types.hpp>
#include <planemap/client/query_types.hpp>
#include <planemap_lcm/request_t.hpp>
#include <span>

#include "lcm/query_answers.hpp"

namespace planemap::client {

/// The questions of a MapClient for whoever answers request_t with reply_t.
class WireQueries {
 public:
  using Timeout = std::chrono::milliseconds;
  /// Gives all pages of the answer to a request, by number. Where the request names the epoch and revision of an
  /// earlier answer, the answer is of these, or an error (kGone).
  using Ask = std::function<Expected<Replies>(const planemap_lcm::request_t& request, Timeout timeout)>;

  explicit WireQueries(Ask ask);

  Expected<Status> status(Timeout timeout) const;
  Expected<Map> snapshot(Timeout timeout) const;
  Expected<Map> cells(Timeout timeout) const;
  Expected<Map> whole_map(Timeout timeout) const;
  Expected<NearestAnswer> nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                  Timeout timeout) const;
  Expected<CastAnswer> cast(std::span<const Ray> rays, const CastOptions& options, Timeout timeout) const;
  Expected<RegionAnswer> region(const RegionQuery& query, Timeout timeout) const;
  Expected<PlaneAnswer> plane(std::int64_t id, Timeout timeout) const;
  Expected<FloorplanAnswer> floorplan(const FloorplanQuery& query, Timeout timeout) const;

 private:
  template <class Add>
  Expected<MapVersion> ask_part(planemap_lcm::request_t request, const MapVersion& version, Timeout timeout,
                                const Add& add) const;

  Ask ask_;
};

}  // namespace planemap::client

#pragma once

#include <memory>
#include <planemap/client/map_client.hpp>
#include <span>

namespace planemap::client {

class WireQueries;

/// What clients have in common that put their questions as planemap_lcm.request_t, whoever answers them.
class WireMapClient : public MapClient {
 public:
  ~WireMapClient() override;

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

 protected:
  explicit WireMapClient(std::unique_ptr<WireQueries> queries);
  const WireQueries& queries() const { return *queries_; }

 private:
  std::unique_ptr<WireQueries> queries_;
};

}  // namespace planemap::client

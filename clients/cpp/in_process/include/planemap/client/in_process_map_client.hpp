#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <planemap/client/map_client.hpp>
#include <planemap/query/snapshot_queries.hpp>
#include <span>
#include <string>

namespace planemap::client {

class WireQueries;

/// Where a map is in this process.
struct MapSource {
  /// The newest map, ready for queries; from any thread, never nullptr.
  std::function<std::shared_ptr<const SnapshotQueries>()> queries;
  std::function<Status()> status;
  std::string frame;  ///< name of the world frame
};

struct InProcessOptions {
  std::chrono::milliseconds look_after{20};  ///< how often a watch looks whether the map has changed
};

/// Asks a map of this process, without a bus: the same questions, checks and answers as from afar. Timeouts are not
/// needed but by watches. Those who need the last digit of a cell or a boundary ask SnapshotQueries itself: here they
/// are floats, as in messages.
class InProcessMapClient final : public MapClient {
 public:
  explicit InProcessMapClient(MapSource source, const InProcessOptions& options = {});
  ~InProcessMapClient() override;

  Expected<Status> status(Timeout timeout) override;
  Expected<Map> snapshot(Timeout timeout) override;
  Expected<Map> cells(Timeout timeout) override;
  Expected<Map> whole_map(Timeout timeout) override;
  Expected<NearestAnswer> nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                  Timeout timeout) override;
  Expected<CastAnswer> cast(std::span<const Ray> rays, const CastOptions& options, Timeout timeout) override;
  Expected<RegionAnswer> region(const RegionQuery& query, Timeout timeout) override;
  Expected<PlaneAnswer> plane(std::int64_t id, Timeout timeout) override;
  Expected<FloorplanAnswer> floorplan(const FloorplanQuery& query, Timeout timeout) override;
  std::unique_ptr<MapWatch> watch() override;

 private:
  class Source;
  std::unique_ptr<Source> source_;
  std::unique_ptr<WireQueries> queries_;
  InProcessOptions options_;
};

}  // namespace planemap::client

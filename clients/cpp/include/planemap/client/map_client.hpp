#pragma once

#include <chrono>
#include <memory>
#include <planemap/client/map_types.hpp>
#include <planemap/client/map_watch.hpp>
#include <planemap/client/query_types.hpp>
#include <span>

namespace planemap::client {

/// Asks a map, wherever it is. Every call blocks up to its timeout, and says in words what went wrong. A client and the
/// watches that it gave are used by one thread.
class MapClient {
 public:
  using Timeout = std::chrono::milliseconds;

  MapClient() = default;
  virtual ~MapClient() = default;
  MapClient(const MapClient&) = delete;
  MapClient& operator=(const MapClient&) = delete;

  virtual Expected<Status> status(Timeout timeout) = 0;
  /// All planes with their boundaries.
  virtual Expected<Map> snapshot(Timeout timeout) = 0;
  /// All dense cells. While mapping goes on their revision is a later one than that of a snapshot before: whole_map()
  /// gives both of one revision.
  virtual Expected<Map> cells(Timeout timeout) = 0;
  /// All planes and the dense cells of the same revision.
  virtual Expected<Map> whole_map(Timeout timeout) = 0;

  /// For each point the planes whose surfaces are nearest; all of one revision, however many points there are.
  virtual Expected<NearestAnswer> nearest(std::span<const QueryPoint> points, const NearestOptions& options,
                                          Timeout timeout) = 0;
  /// For each ray the first plane and the first dense cell that it meets; all of one revision.
  virtual Expected<CastAnswer> cast(std::span<const Ray> rays, const CastOptions& options, Timeout timeout) = 0;
  /// What is in a part of space.
  virtual Expected<RegionAnswer> region(const RegionQuery& query, Timeout timeout) = 0;
  /// Everything about a plane, also where it was merged into another one.
  virtual Expected<PlaneAnswer> plane(std::int64_t id, Timeout timeout) = 0;
  /// Walls and free floor, seen from above.
  virtual Expected<FloorplanAnswer> floorplan(const FloorplanQuery& query, Timeout timeout) = 0;

  /// Keeps up with the map. The client must outlive what it gives.
  virtual std::unique_ptr<MapWatch> watch() = 0;
};

}  // namespace planemap::client

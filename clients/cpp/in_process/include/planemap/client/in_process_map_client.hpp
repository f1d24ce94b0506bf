#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <planemap/client/wire_map_client.hpp>
#include <planemap/query/snapshot_queries.hpp>
#include <string>

namespace planemap::client {

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
class InProcessMapClient final : public WireMapClient {
 public:
  explicit InProcessMapClient(MapSource source, const InProcessOptions& options = {});
  ~InProcessMapClient() override;

  Expected<Status> status(Timeout timeout) override;
  std::unique_ptr<MapWatch> watch() override;

 private:
  class Source;
  Expected<std::vector<planemap_lcm::reply_t>> ask(const planemap_lcm::request_t& request, Timeout timeout) override;

  std::unique_ptr<Source> source_;
  InProcessOptions options_;
};

}  // namespace planemap::client

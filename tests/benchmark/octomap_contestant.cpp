#include "common/stopwatch.hpp"
#include "contestant.hpp"
#include "octomap_endpoints.hpp"

namespace planemap::benchmark {

namespace {

/// Marks the cells that hold end points as occupied, each once a frame; no rays.
class OctomapEndpoints final : public Contestant {
 public:
  explicit OctomapEndpoints(double resolution_m) : tree_(resolution_m) {}

  PartTimes take(const BenchFrame& frame) override {
    const Stopwatch whole;
    mark_endpoints(frame.xyz_world_m, keys_, tree_);
    tree_.updateInnerOccupancy();
    return {{"octomapEndpoints", whole.ms(), whole.own_ms()}};
  }

 private:
  octomap::OcTree tree_;
  octomap::KeySet keys_;
};

}  // namespace

std::unique_ptr<Contestant> make_octomap_endpoints(double resolution_m) {
  return std::make_unique<OctomapEndpoints>(resolution_m);
}

}  // namespace planemap::benchmark

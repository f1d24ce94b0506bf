#include <octomap/octomap.h>

#include "common/stopwatch.hpp"
#include "contestant.hpp"

namespace planemap::benchmark {

namespace {

/// Marks the cells that hold end points as occupied, each once a frame; no rays.
class OctomapEndpoints final : public Contestant {
 public:
  explicit OctomapEndpoints(double resolution_m) : tree_(resolution_m) {}

  PartTimes take(const BenchFrame& frame) override {
    const Stopwatch whole;
    keys_.clear();
    for (std::size_t i = 0; i < frame.xyz_world_m.size(); i += 3) {
      octomap::OcTreeKey key;
      if (tree_.coordToKeyChecked(frame.xyz_world_m[i], frame.xyz_world_m[i + 1], frame.xyz_world_m[i + 2], key)) {
        keys_.insert(key);
      }
    }
    for (const octomap::OcTreeKey& key : keys_) tree_.updateNode(key, true, /*lazy_eval=*/true);
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

#include "planemap/map_check.hpp"

#include <cmath>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "planemap/block.hpp"

namespace planemap {

namespace {

/// Block indexes beyond this have cells that an int cannot name.
constexpr int kFarthestBlock = 1 << 27;
constexpr std::uint64_t kGreatestId = 0xfffffff0;  // slots are 32 bits
constexpr std::uint64_t kGreatestNumber = 1ULL << 53;

std::string text_of(const BlockIndex& i) {
  return "(" + std::to_string(i.x()) + ", " + std::to_string(i.y()) + ", " + std::to_string(i.z()) + ")";
}

bool is_finite(const Cell& cell) {
  const auto& evidence = cell.evidence;
  float sum = evidence.weight + evidence.first.sum() + cell.evidence_count + cell.normal.sum() + cell.deviation_rad +
              cell.normal_count + cell.plane_weight + cell.sums.square_m2.sum() + cell.sums.error_m2.sum() +
              cell.sums.view.sum();
  for (const float x : evidence.second) sum += x;
  return std::isfinite(sum) && std::isfinite(cell.sums.count) && cell.sums.first_m.allFinite();
}

/// What is wrong with a cell by itself; nullptr: nothing.
const char* problem_of(const Cell& cell) {
  if (!is_finite(cell)) return "has a number that is not finite";
  if (cell.sums.count < 0.0 || cell.evidence_count < 0.0F || cell.evidence.weight < 0.0F || cell.normal_count < 0.0F) {
    return "has a negative count";
  }
  if (cell.plane != kNoSlot && !(cell.sums.count > 0.0)) return "has no points, but a plane";
  if (!(cell.plane_weight >= 0.0F && cell.plane_weight <= 1.0F)) return "shapes its plane by more than all it has";
  if (cell.has_normal() && std::abs(cell.normal.norm() - 1.0F) > 1e-3F) return "has a normal that is no unit vector";
  if (cell.working != Cell::kNotWorking) return "is at work";
  return nullptr;
}

Expected<void> check_plane(const PlaneRecord& plane, std::size_t labelled, const MapperState& state) {
  const std::string name = "plane " + std::to_string(plane.id);
  if (plane.id == kNoPlane || plane.id >= state.next_plane_id) return fail(name + ": the id was never given");
  if (!plane.state) return fail(name + ": what the mapper knows of it is missing");
  bool finite = plane.covariance.allFinite() && plane.centroid_m.allFinite() && std::isfinite(plane.quality);
  const auto look = [&](auto number) { finite = finite && std::isfinite(static_cast<double>(number)); };
  PlaneStatistics::visit_numbers(plane.state->statistics, look);
  PoseEvidence::visit_numbers(plane.state->pose_evidence, look);
  const PlaneFit& fit = plane.state->fit;
  finite = finite && fit.centroid_m.allFinite() && fit.tangent_1.allFinite() && fit.tangent_2.allFinite();
  for (const double x : {fit.spread_1_m2, fit.spread_2_m2, fit.residual_m2, fit.deviation_rad, fit.weight,
                         fit.tilt_1_rad2, fit.tilt_2_rad2, fit.cell_dispersion}) {
    look(x);
  }
  if (!finite) return fail(name + " has a number that is not finite");
  const std::size_t counted = plane.state->statistics.cell_count();
  if (counted != labelled || counted != plane.cell_count) {
    return fail(name + " counts " + std::to_string(counted) + " cells, but " + std::to_string(labelled) +
                " carry its label");
  }
  return {};
}

}  // namespace

Expected<void> check_map(const MapperConfig& config, const MapSnapshot& map) {
  if (map.cell_size_m() != config.grid.cell_size_m) {
    return fail("the map's cells are " + std::to_string(map.cell_size_m()) + " m wide, the configuration's " +
                std::to_string(config.grid.cell_size_m) + " m (grid.cell_size_m)");
  }
  const MapperState& state = map.state();
  if (map.epoch() >= kGreatestNumber || map.revision() >= kGreatestNumber || state.next_plane_id == 0 ||
      state.next_plane_id > kGreatestId) {
    return fail("epoch, revision or the next plane's id is out of range");
  }
  if (!state.last_pose.allFinite() || !std::isfinite(state.pose_variance_m2) || state.scans < 0) {
    return fail("what is known of the poses' errors is not finite");
  }
  std::unordered_set<BlockIndex, BlockIndexHash> seen;
  std::unordered_map<PlaneSlot, std::size_t> labelled;
  for (const auto& block : map.blocks()) {
    const BlockIndex& index = block->index();
    if (index.minCoeff() < -kFarthestBlock || index.maxCoeff() > kFarthestBlock) {
      return fail("block " + text_of(index) + " is out of range");
    }
    if (!seen.insert(index).second) return fail("block " + text_of(index) + " is there twice");
    for (std::size_t i = 0; i < block->size(); ++i) {
      const Cell& cell = block->cell(i);
      if (const char* problem = problem_of(cell)) return fail("cell " + text_of(block->cell_index(i)) + " " + problem);
      if (cell.plane != kNoSlot) ++labelled[cell.plane];
    }
  }
  PlaneId last = kNoPlane;
  for (const auto& plane : map.planes()) {
    if (plane->id <= last) return fail("the planes are not in the order of their ids");
    last = plane->id;
    const auto found = labelled.find(static_cast<PlaneSlot>(plane->id));
    const std::size_t cells = found == labelled.end() ? 0 : found->second;
    if (auto good = check_plane(*plane, cells, state); !good) return good;
    if (found != labelled.end()) labelled.erase(found);
  }
  if (!labelled.empty())
    return fail("cells carry the label of plane " + std::to_string(labelled.begin()->first) + ", which is not there");
  return {};
}

}  // namespace planemap

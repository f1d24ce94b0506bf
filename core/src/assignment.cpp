#include "planemap/assignment.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "planemap/expected_distance.hpp"
#include "planemap/scan_points.hpp"

namespace planemap {

namespace {

/// floor() by conversion: std::floor is a call without SSE4.1. @pre |x| < 2^31
inline int floor_to_int(double x) {
  const int i = static_cast<int>(x);
  return i - static_cast<int>(x < i);
}

/// Which eighth of a cell a point lies in, from its place relative to the cell's centre: a bit for each axis.
inline std::uint32_t eighth_of(const Eigen::Vector3d& q_m) {
  return static_cast<std::uint32_t>(q_m.x() >= 0.0) | static_cast<std::uint32_t>(q_m.y() >= 0.0) << 1 |
         static_cast<std::uint32_t>(q_m.z() >= 0.0) << 2;
}

/// Points beyond are not representable as cell indices; a map of that size is a mistake in the pose.
constexpr double kMaxCoordinateCells = 1e9;

}  // namespace

PointCounts Assigner::assign(UncertainGrid& grid, const Scan& scan, const Eigen::Isometry3d& T_world_sensor) {
  changes_.clear();
  own_of_change_.clear();
  own_.clear();
  candidates_.clear();
  R_squared_ = T_world_sensor.rotation().cwiseAbs2();
  const PointCounts counts = std::visit([&](const auto& s) { return assign_points(grid, s, T_world_sensor); }, scan);

  std::uint32_t kept = 0;
  for (CellChange& change : changes_) {
    Cell& cell = grid.writable(change.cell);
    cell.working = Cell::kNotWorking;
    if (change.added.count() <= 0.0) continue;  // all points that lie in it went to its neighbours
    cell.working = kept;
    // One view direction for a cell and scan: it turns by a fraction of a degree within the cell.
    const Eigen::Vector3d mean_m = grid.geometric_centre_m(change.cell) + change.added.points.mean();
    const Eigen::Vector3d view = (T_world_sensor.translation() - mean_m).normalized() * change.added.count();
    change.added.view = view.cast<float>();
    changes_[kept++] = change;
  }
  changes_.resize(kept);
  return counts;
}

void Assigner::finish(UncertainGrid& grid) {
  for (const CellChange& change : changes_) grid.writable(change.cell).working = Cell::kNotWorking;
}

template <class ScanType>
PointCounts Assigner::assign_points(UncertainGrid& grid, const ScanType& scan,
                                    const Eigen::Isometry3d& T_world_sensor) {
  const double inverse_size = 1.0 / grid.cell_size_m();
  const double quarter_edge_m = 0.25 * grid.cell_size_m();
  const Eigen::Vector3d origin = T_world_sensor.translation();
  Run run;
  CellIndex last_index = CellIndex::Constant(std::numeric_limits<int>::min());
  std::uint32_t last_own = 0;
  std::size_t too_far = 0;

  PointCounts counts = for_each_point(scan, T_world_sensor, sensor_, [&](const UncertainPoint& point) {
    const Eigen::Vector3d scaled = point.p_world_m * inverse_size;
    if (!(scaled.cwiseAbs().maxCoeff() < kMaxCoordinateCells)) {
      ++too_far;
      return;
    }
    const CellIndex index(floor_to_int(scaled.x()), floor_to_int(scaled.y()), floor_to_int(scaled.z()));
    if (index != last_index) {
      last_own = own_cell(grid, index, origin);
      last_index = index;
    }
    OwnCell& own = own_[last_own];
    const Eigen::Vector3d q = point.p_world_m - own.centre_m;
    const std::uint32_t eighth = eighth_of(q);
    if (own.eighths[eighth].count == 0) list_eighth(own, eighth, quarter_edge_m);
    const CellRef winner = nearest(own.eighths[eighth], q).cell;

    if (run.n == 0.0 || run.own != last_own || run.cell != winner) {
      if (run.n > 0.0) flush(grid, run);
      run = {last_own, winner, 1.0, q, Symmetric3::outer(q), point.variance_sensor_m2};
      return;
    }
    run.n += 1.0;
    run.first_m += q;
    const Symmetric3 square = Symmetric3::outer(q);
    for (std::size_t i = 0; i < 6; ++i) run.second_m2.e[i] += square.e[i];
    run.variance_sensor_m2 += point.variance_sensor_m2;
  });
  if (run.n > 0.0) flush(grid, run);
  counts.mapped -= too_far;
  counts.out_of_range += too_far;
  return counts;
}

const Assigner::Candidate& Assigner::nearest(Range range, const Eigen::Vector3d& q_m) const {
  const Candidate* best = &candidates_[range.first];
  if (range.count == 1) return *best;
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate* c = best; c != &candidates_[range.first] + range.count; ++c) {
    // Eq. 7 without the terms that are the same for all candidates.
    const double dx = q_m.x() - c->x;
    const double dy = q_m.y() - c->y;
    const double dz = q_m.z() - c->z;
    const double distance = dx * dx + dy * dy + dz * dz + c->bias;
    if (distance >= least) continue;
    least = distance;
    best = c;
  }
  return *best;
}

std::uint32_t Assigner::own_cell(UncertainGrid& grid, const CellIndex& index, const Eigen::Vector3d& origin_m) {
  const CellRef ref = grid.find_or_add(index);
  const std::uint32_t change = working(grid, ref);
  if (own_of_change_[change] >= 0) return static_cast<std::uint32_t>(own_of_change_[change]);

  OwnCell own;
  own.centre_m = grid.geometric_centre_m(index);
  list_candidates(grid, own, ref, origin_m);
  own_of_change_[change] = static_cast<std::int32_t>(own_.size());
  own_.push_back(own);
  return static_cast<std::uint32_t>(own_.size() - 1);
}

void Assigner::list_candidates(const UncertainGrid& grid, OwnCell& own, CellRef ref, const Eigen::Vector3d& origin_m) {
  own.all.first = static_cast<std::uint32_t>(candidates_.size());
  if (grid.cell(ref).sums.count() <= 0.0) {
    candidates_.push_back({0.0, 0.0, 0.0, 0.0, ref});
    own.all.count = 1;
    own.eighths.fill(own.all);
    return;
  }
  const double half = 0.5 * grid.cell_size_m();
  const Eigen::Vector3f view = (origin_m - own.centre_m).cast<float>();
  grid.for_each_neighbour(ref, 1, [&](CellRef other) {
    const Cell& cell = grid.cell(other);
    if (cell.sums.count() <= 0.0) return;
    // The faces of a thin wall: a cell that was seen from the other side does not attract these points.
    if (config_.view_side && other != ref && cell.sums.view.dot(view) < 0.0F) return;
    const CentreStatistics statistics{cell.sums.count(), cell.sums.points.first, cell.sums.error_m2};
    Eigen::Vector3d centre = expected_centre(statistics);
    if (config_.clamp_centres) centre = centre.cwiseMax(-half).cwiseMin(half);
    centre += grid.geometric_centre_m(other) - own.centre_m;
    candidates_.push_back({centre.x(), centre.y(), centre.z(), centre_variance(statistics), other});
  });
  own.all.count = static_cast<std::uint32_t>(candidates_.size()) - own.all.first;
}

void Assigner::list_eighth(OwnCell& own, std::uint32_t eighth, double quarter_edge_m) {
  const auto side = [&](std::uint32_t bit) { return (eighth & bit) != 0 ? quarter_edge_m : -quarter_edge_m; };
  own.eighths[eighth] = without_losers(own.all, {side(1), side(2), side(4)}, quarter_edge_m);
}

Assigner::Range Assigner::without_losers(Range range, const Eigen::Vector3d& middle_m, double half_edge_m) {
  // The difference of two candidates' distances is affine in the point: who loses to another on all eight corners of a
  // box loses everywhere in it. The other is the winner at the middle, which strikes out nearly all that can be.
  const auto at_middle = [&](const Candidate& c) {
    return (middle_m - Eigen::Vector3d(c.x, c.y, c.z)).squaredNorm() + c.bias;
  };
  const Candidate winner = nearest(range, middle_m);
  const double least = at_middle(winner);
  const auto first = static_cast<std::uint32_t>(candidates_.size());
  for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
    const Candidate c = candidates_[i];
    // distance(c) - distance(winner) is least where each coordinate pulls hardest towards c.
    const double pull = std::abs(c.x - winner.x) + std::abs(c.y - winner.y) + std::abs(c.z - winner.z);
    if (at_middle(c) - least - 2.0 * half_edge_m * pull <= 0.0) candidates_.push_back(c);
  }
  return {first, static_cast<std::uint32_t>(candidates_.size()) - first};
}

std::uint32_t Assigner::working(UncertainGrid& grid, CellRef ref) {
  Cell& cell = grid.writable(ref);
  if (cell.working == Cell::kNotWorking) {
    cell.working = static_cast<std::uint32_t>(changes_.size());
    changes_.push_back({ref, {}});
    own_of_change_.push_back(-1);
  }
  return cell.working;
}

void Assigner::flush(UncertainGrid& grid, const Run& run) {
  CellSums& added = changes_[working(grid, run.cell)].added;
  const Eigen::Vector3d shift_m = own_[run.own].centre_m - grid.geometric_centre_m(run.cell);
  added.points.add(Moments{run.n, run.first_m, run.second_m2}, 1.0, shift_m);
  added.error_m2 += R_squared_ * run.variance_sensor_m2;
}

}  // namespace planemap

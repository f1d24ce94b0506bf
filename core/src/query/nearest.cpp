#include "planemap/query/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "query/argument_checks.hpp"
#include "query/queries.hpp"
#include "query/uncertainty.hpp"

namespace planemap {

namespace {

struct Candidate {
  double distance_m;
  std::size_t plane;  ///< places go by id
  Spot spot;

  bool operator<(const Candidate& other) const {
    return distance_m != other.distance_m ? distance_m < other.distance_m : plane < other.plane;
  }
};

/// The best few so far; a heap whose top is the worst of them.
class Best {
 public:
  explicit Best(std::size_t count) : count_(count) { candidates_.reserve(std::min<std::size_t>(count, 64)); }

  /// @return whether there is no room for worse ones
  bool take(const Candidate& candidate) {
    if (candidates_.size() < count_) {
      candidates_.push_back(candidate);
      std::push_heap(candidates_.begin(), candidates_.end());
    } else if (candidate < candidates_.front()) {
      std::pop_heap(candidates_.begin(), candidates_.end());
      candidates_.back() = candidate;
      std::push_heap(candidates_.begin(), candidates_.end());
    }
    return candidates_.size() == count_;
  }
  double worst_m() const { return candidates_.front().distance_m; }
  std::vector<Candidate> sorted() {
    std::sort_heap(candidates_.begin(), candidates_.end());
    return std::move(candidates_);
  }

 private:
  std::size_t count_;
  std::vector<Candidate> candidates_;
};

std::optional<Error> check(const NearestQuery& query, const MapSnapshot& snapshot) {
  if (auto error = check_coordinates("point_m", query.point_m)) return error;
  if (auto error = check_covariance("covariance_m2", query.covariance_m2)) return error;
  if (query.count == 0) return Error{"count: must be at least 1, is 0"};
  if (!(query.max_distance_m >= 0.0)) {
    return Error{"max_distance_m: must be at least 0, is " + text_of(query.max_distance_m)};
  }
  return check_filter(query.filter, snapshot);
}

double mahalanobis_of(double distance_m, double sigma_m) {
  if (sigma_m > 0.0) return std::abs(distance_m) / sigma_m;
  return distance_m == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
}

NearPlane describe(const QueryIndex& index, const NearestQuery& query, const Candidate& candidate) {
  const PlaneRecord& record = *index.planes[candidate.plane].record;
  NearPlane near;
  near.id = record.id;
  near.surface_distance_m = candidate.distance_m;
  near.surface_point_m = index.surfaces[candidate.plane]->basis().to_world(candidate.spot.nearest_m);
  near.signed_distance_m = record.plane.signed_distance_m(query.point_m);
  near.sigma_m = std::sqrt(distance_variance_m2(record, query.point_m, query.covariance_m2));
  near.mahalanobis = mahalanobis_of(near.signed_distance_m, near.sigma_m);
  near.foot_m = query.point_m - near.signed_distance_m * record.plane.normal();
  near.foot_inside = candidate.spot.inside;
  return near;
}

}  // namespace

Expected<std::vector<NearPlane>> nearest_planes(const QueryIndex& index, const NearestQuery& query) {
  if (auto error = check(query, *index.snapshot)) return failure(error);
  const FilterTest filter(index, query.filter);
  Best best(query.count);
  index.tree.visit_near(query.point_m, query.max_distance_m, [&](PlaneTree::Item plane, double limit_m) {
    const double off_m = index.planes[plane].record->plane.signed_distance_m(query.point_m);
    if (std::abs(off_m) > limit_m || !filter.passes(plane)) return limit_m;
    const PreparedSurface& surface = *index.surfaces[plane];
    const Spot spot = surface.spot(surface.basis().to_plane(query.point_m));
    const double distance_m = std::hypot(off_m, spot.distance_m);
    if (distance_m > limit_m) return limit_m;
    return best.take({distance_m, plane, spot}) ? std::min(limit_m, best.worst_m()) : limit_m;
  });
  std::vector<NearPlane> found;
  for (const Candidate& candidate : best.sorted()) found.push_back(describe(index, query, candidate));
  return found;
}

}  // namespace planemap

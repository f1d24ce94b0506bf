#include "query/query_index.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace planemap {

namespace {

std::uint32_t bit_of(PlaneClass c) {
  return std::uint32_t{1} << static_cast<unsigned>(c);
}

}  // namespace

double normal_deviation_rad(const PlaneRecord& record) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(record.covariance.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues()[2], 0.0));
}

std::optional<std::size_t> QueryIndex::find(PlaneId id) const {
  const auto at = std::lower_bound(planes.begin(), planes.end(), id, [](const DescribedPlane& plane, PlaneId wanted) {
    return plane.record->id < wanted;
  });
  if (at == planes.end() || at->record->id != id) return std::nullopt;
  return static_cast<std::size_t>(at - planes.begin());
}

FilterTest::FilterTest(const QueryIndex& index, const PlaneFilter& filter) : index_(index), filter_(filter) {
  for (const PlaneClass c : filter.classes) classes_ |= bit_of(c);
  if (filter.classes.empty()) classes_ = ~std::uint32_t{0};
  const PlaneFilter all;
  passes_all_ = filter.classes.empty() && filter.min_area_m2 <= all.min_area_m2 &&
                filter.max_normal_deviation_rad >= all.max_normal_deviation_rad &&
                filter.seen_since_utime <= all.seen_since_utime;
}

bool FilterTest::passes(std::size_t plane) const {
  if (passes_all_) return true;
  const DescribedPlane& described = index_.planes[plane];
  return (classes_ & bit_of(described.plane_class)) != 0 && described.outline->area_m2 >= filter_.min_area_m2 &&
         index_.normal_deviations_rad[plane] <= filter_.max_normal_deviation_rad &&
         described.record->last_seen_utime >= filter_.seen_since_utime;
}

bool FilterTest::passes_cell_of(PlaneId id) const {
  if (passes_all_) return true;
  const auto plane = index_.find(id);
  return plane && passes(*plane);
}

}  // namespace planemap

#include "planemap/query/snapshot_queries.hpp"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "describe.hpp"
#include "query/argument_checks.hpp"
#include "query/queries.hpp"
#include "query/query_index.hpp"

namespace planemap {

namespace {

/// Surfaces of outlines that an earlier index had are taken from it.
void add_surfaces(const QueryIndex* previous, QueryIndex& index) {
  std::unordered_map<const Outline*, std::shared_ptr<const PreparedSurface>> known;
  if (previous != nullptr) {
    known.reserve(previous->planes.size());
    for (std::size_t i = 0; i < previous->planes.size(); ++i) {
      known.emplace(previous->planes[i].outline.get(), previous->surfaces[i]);
    }
  }
  std::vector<Eigen::AlignedBox3d> boxes;
  boxes.reserve(index.planes.size());
  for (const DescribedPlane& plane : index.planes) {
    const auto found = known.find(plane.outline.get());
    index.surfaces.push_back(found != known.end() ? found->second
                                                  : std::make_shared<const PreparedSurface>(*plane.outline));
    boxes.push_back(index.surfaces.back()->box());
    index.normal_deviations_rad.push_back(normal_deviation_rad(*plane.record));
  }
  index.tree = PlaneTree(boxes);
}

void check_described(const MapSnapshot& snapshot, std::span<const DescribedPlane> planes) {
  const auto records = snapshot.planes();
  const bool all = std::equal(planes.begin(), planes.end(), records.begin(), records.end(),
                              [](const DescribedPlane& plane, const auto& record) {
                                return plane.record == record && plane.outline != nullptr;
                              });
  if (!all) throw std::invalid_argument("SnapshotQueries: planes must be all of the snapshot's, by id, with outlines");
}

std::unique_ptr<const QueryIndex> index_of(std::shared_ptr<const MapSnapshot> snapshot,
                                           std::optional<std::vector<DescribedPlane>> planes,
                                           const std::optional<Eigen::Vector3d>& gravity, const QueryIndex* previous) {
  if (gravity && !(gravity->allFinite() && gravity->norm() > 0.0)) {
    throw std::invalid_argument("SnapshotQueries: gravity must be finite and not zero");
  }
  auto index = std::make_unique<QueryIndex>();
  if (gravity) index->up = -gravity->normalized();
  index->plane_blocks = PlaneBlocks(snapshot->blocks(), previous != nullptr ? &previous->plane_blocks : nullptr);
  if (planes) {
    check_described(*snapshot, *planes);
    index->planes = std::move(*planes);
  } else {
    const auto known = previous != nullptr ? std::span(previous->planes) : std::span<const DescribedPlane>{};
    index->planes = describe_planes(*snapshot, gravity, known, index->plane_blocks);
  }
  add_surfaces(previous, *index);
  index->blocks = previous != nullptr && previous->blocks->is_of(snapshot->blocks())
                      ? previous->blocks
                      : std::make_shared<const BlockIndexTable>(snapshot->blocks());
  index->snapshot = std::move(snapshot);
  return index;
}

}  // namespace

SnapshotQueries::SnapshotQueries(std::shared_ptr<const MapSnapshot> snapshot,
                                 const std::optional<Eigen::Vector3d>& gravity, const SnapshotQueries* previous)
    : index_(index_of(std::move(snapshot), std::nullopt, gravity,
                      previous != nullptr ? previous->index_.get() : nullptr)) {}

SnapshotQueries::SnapshotQueries(std::shared_ptr<const MapSnapshot> snapshot, std::vector<DescribedPlane> planes,
                                 const std::optional<Eigen::Vector3d>& gravity, const SnapshotQueries* previous)
    : index_(index_of(std::move(snapshot), std::move(planes), gravity,
                      previous != nullptr ? previous->index_.get() : nullptr)) {}

SnapshotQueries::~SnapshotQueries() = default;

const MapSnapshot& SnapshotQueries::snapshot() const {
  return *index_->snapshot;
}

std::span<const DescribedPlane> SnapshotQueries::planes() const {
  return index_->planes;
}

Expected<std::vector<NearPlane>> SnapshotQueries::nearest(const NearestQuery& query) const {
  return nearest_planes(*index_, query);
}

Expected<std::vector<RayHits>> SnapshotQueries::cast(std::span<const Ray> rays, const CastOptions& options) const {
  return cast_rays(*index_, rays, options);
}

Expected<RegionContents> SnapshotQueries::region(const RegionQuery& query) const {
  return contents_of(*index_, query);
}

Expected<PlaneLookup> SnapshotQueries::plane(PlaneId id) const {
  return look_up(*index_, id);
}

Expected<FilterMatch> SnapshotQueries::matching(const PlaneFilter& filter) const {
  if (auto error = check_filter(filter, *index_->snapshot)) return tl::make_unexpected(*error);
  const FilterTest test(*index_, filter);
  FilterMatch match;
  match.planes.reserve(index_->planes.size());
  for (std::size_t i = 0; i < index_->planes.size(); ++i) {
    if (test.passes(i)) match.planes.push_back(index_->planes[i].record->id);
  }
  match.other_cells = test.passes_cell_of(kNoPlane);
  return match;
}

Expected<Floorplan> SnapshotQueries::floorplan(const FloorplanQuery& query) const {
  return floorplan_of(*index_, query);
}

}  // namespace planemap

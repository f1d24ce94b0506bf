#include "planemap/query/ray_cast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <planemap/query/limits.hpp>
#include <string>

#include "query/argument_checks.hpp"
#include "query/grid_walk.hpp"
#include "query/queries.hpp"
#include "query/uncertainty.hpp"

namespace planemap {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

std::optional<Error> check(const Ray& ray, std::size_t number) {
  const auto name = [&](const char* field) { return "rays[" + std::to_string(number) + "]." + field; };
  if (auto error = check_coordinates(name("origin_m"), ray.origin_m)) return error;
  if (!ray.direction.allFinite()) return Error{name("direction") + ": not every number is finite"};
  if (!(ray.direction.cwiseAbs().maxCoeff() > 0.0)) return Error{name("direction") + ": must not be zero"};
  if (!(ray.max_range_m > 0.0)) {
    return Error{name("max_range_m") + ": must be greater than 0, is " + text_of(ray.max_range_m)};
  }
  return std::nullopt;
}

/// Range at which a ray meets the endless plane; infinity: not ahead, or it runs along it.
double range_of(const RayLine& ray, const Plane& plane) {
  const double cosine = plane.normal().dot(ray.direction);
  if (std::abs(cosine) < kLeastCosine) return kNever;
  const double range_m = -plane.signed_distance_m(ray.origin_m) / cosine;
  if (range_m >= 0.0) return range_m;
  return range_m >= -kOnBorderM ? 0.0 : kNever;
}

std::optional<PlaneHit> first_plane(const QueryIndex& index, const FilterTest& filter, const RayLine& ray,
                                    double max_range_m) {
  double best_m = kNever;
  std::size_t best = 0;
  index.tree.visit_along(ray, max_range_m, [&](PlaneTree::Item plane, double limit_m) {
    const double range_m = range_of(ray, index.planes[plane].record->plane);
    if (range_m > limit_m || range_m == kNever || (range_m == best_m && plane > best)) return limit_m;
    const PreparedSurface& surface = *index.surfaces[plane];
    if (!filter.passes(plane) || !surface.contains(surface.basis().to_plane(ray.at(range_m)))) return limit_m;
    best_m = range_m;
    best = plane;
    return range_m;
  });
  if (best_m == kNever) return std::nullopt;
  const PlaneRecord& record = *index.planes[best].record;
  const double cosine = record.plane.normal().dot(ray.direction);
  PlaneHit hit;
  hit.id = record.id;
  hit.range_m = best_m;
  hit.point_m = ray.at(best_m);
  hit.sigma_m = range_sigma_m(record, hit.point_m, cosine);
  hit.incidence_rad = std::acos(std::min(std::abs(cosine), 1.0));
  hit.from_behind = cosine > 0.0;
  return hit;
}

CellHit describe(const MapSnapshot& snapshot, const Block& block, std::size_t ordinal, const RayLine& ray,
                 double entry_m) {
  CellHit hit;
  hit.cell = snapshot.view_of(block, ordinal);
  hit.entry_m = entry_m;
  hit.range_m = std::max(ray.direction.dot(hit.cell.centre_m - ray.origin_m), 0.0);
  hit.sigma_m = ray.direction.cwiseProduct(hit.cell.sigma_m).norm();
  if (hit.cell.normal) hit.incidence_rad = std::acos(std::min(std::abs(hit.cell.normal->dot(ray.direction)), 1.0));
  return hit;
}

/// The first dense cell of a block that the ray meets.
std::optional<CellHit> first_cell_in(const MapSnapshot& snapshot, const Block& block, const FilterTest& filter,
                                     const RayLine& ray, double from_m, double max_range_m) {
  const CellIndex corner = block.index() * kBlockEdge;
  const Eigen::AlignedBox3i cells(corner, corner + CellIndex::Constant(kBlockEdge - 1));
  GridWalk walk(ray, snapshot.cell_size_m(), from_m, cells);
  do {
    if (walk.entry_m() > max_range_m) return std::nullopt;
    const int first = block.find(place_of(walk.index()));
    if (first < 0) continue;
    std::optional<CellHit> hit;  // of the two cells that a place may have, the nearer one
    for (std::uint16_t at = static_cast<std::uint16_t>(first); at != Cell::kNoSecond; at = block.cell(at).second) {
      const Cell& cell = block.cell(at);
      if (!snapshot.is_dense(cell) || !filter.passes_cell_of(cell.plane)) continue;
      CellHit found = describe(snapshot, block, at, ray, walk.entry_m());
      if (!hit || found.range_m < hit->range_m) hit = found;
    }
    if (hit) return hit;
  } while (walk.step());
  return std::nullopt;
}

std::optional<CellHit> first_cell(const QueryIndex& index, const FilterTest& filter, const RayLine& ray,
                                  double max_range_m) {
  const Eigen::AlignedBox3i& extent = index.blocks->extent();
  if (extent.isEmpty()) return std::nullopt;
  const MapSnapshot& snapshot = *index.snapshot;
  const double edge_m = snapshot.cell_size_m() * kBlockEdge;
  const Eigen::AlignedBox3d all(extent.min().cast<double>() * edge_m,
                                (extent.max().cast<double>().array() + 1.0) * edge_m);
  const double from_m = ray.entry_m(all);
  if (from_m > max_range_m || from_m == kNever) return std::nullopt;
  GridWalk walk(ray, edge_m, from_m, extent);
  do {
    if (walk.entry_m() > max_range_m) return std::nullopt;
    const std::int32_t slot = index.blocks->find(walk.index());
    if (slot < 0) continue;
    const Block& block = *snapshot.blocks()[static_cast<std::size_t>(slot)];
    if (auto hit = first_cell_in(snapshot, block, filter, ray, walk.entry_m(), max_range_m)) return hit;
  } while (walk.step());
  return std::nullopt;
}

}  // namespace

Expected<std::vector<RayHits>> cast_rays(const QueryIndex& index, std::span<const Ray> rays,
                                         const CastOptions& options) {
  if (auto error = check_filter(options.filter, *index.snapshot)) return failure(error);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (auto error = check(rays[i], i)) return failure(error);
  }
  const FilterTest filter(index, options.filter);
  std::vector<RayHits> hits;
  hits.reserve(rays.size());
  for (const Ray& ray : rays) {
    // Divided first: the square of a very long or short direction is no number.
    const RayLine line(ray.origin_m, (ray.direction / ray.direction.cwiseAbs().maxCoeff()).normalized());
    RayHits& found = hits.emplace_back();
    if (options.planes) found.plane = first_plane(index, filter, line, ray.max_range_m);
    if (options.cells) found.cell = first_cell(index, filter, line, ray.max_range_m);
  }
  return hits;
}

}  // namespace planemap

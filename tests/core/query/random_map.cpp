#include "query/random_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <planemap/block.hpp>
#include <tuple>

namespace planemap::testing {

using Eigen::Vector2d;
using Eigen::Vector3d;

Eigen::Isometry3d Random::pose(double half_m) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (!one_in(4)) T.linear() = Eigen::Quaterniond(normal(), normal(), normal(), normal()).normalized().matrix();
  T.translation() = in_cube(half_m);
  return T;
}

Eigen::Matrix3d Random::covariance(double sigma_m) {
  Eigen::Matrix3d root;
  root << normals(), normals(), normals();
  return sigma_m * sigma_m / 3.0 * (root * root.transpose());
}

namespace {

/// Corners around a centre, at random distances: never crosses itself.
Ring star(Random& random, const Vector2d& centre_m, double least_m, double most_m) {
  Ring ring;
  const int corners = 3 + random.below(10);
  const double turn_rad = random.uniform(0.0, 2.0 * M_PI);
  for (int i = 0; i < corners; ++i) {
    const double angle_rad = turn_rad + 2.0 * M_PI * i / corners;
    ring.push_back(centre_m + random.uniform(least_m, most_m) * Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  }
  return ring;
}

Polygon ragged_polygon(Random& random, const Vector2d& centre_m) {
  const double least_m = random.uniform(0.1, 1.0);
  Polygon polygon{star(random, centre_m, least_m, least_m * random.uniform(1.0, 3.0)), {}};
  // A triangle reaches inwards to half of its corners' distance.
  if (random.one_in(2)) {
    Ring hole = star(random, centre_m, 0.1 * least_m, 0.45 * least_m);
    std::reverse(hole.begin(), hole.end());
    polygon.holes.push_back(std::move(hole));
  }
  return polygon;
}

DescribedPlane random_plane(Random& random, PlaneId id) {
  Vector3d normal = random.unit();
  if (random.one_in(3)) normal = (random.one_in(2) ? 1.0 : -1.0) * Vector3d::Unit(random.below(3));
  PlaneRecord record = record_of(id, random.in_cube(5.0), normal, random.uniform(0.0, 0.01), random.uniform(0.0, 0.02));
  record.last_seen_utime = 1000 + random.below(1000);
  Outline outline;
  outline.basis = basis_of(record.plane, record.centroid_m);
  if (!random.one_in(10)) outline.polygons.push_back(ragged_polygon(random, Vector2d::Zero()));
  if (random.one_in(4)) outline.polygons.push_back(ragged_polygon(random, {7.0, 1.0}));
  outline.area_m2 = outline.polygons.empty() ? 0.0 : random.uniform(0.1, 3.0);
  return described(record, outline, static_cast<PlaneClass>(random.below(6)));
}

}  // namespace

Outline rectangle(const PlaneRecord& record, double width_m, double height_m) {
  const double u = 0.5 * width_m;
  const double v = 0.5 * height_m;
  Outline outline;
  outline.basis = basis_of(record.plane, record.centroid_m);
  outline.polygons.push_back({{{-u, -v}, {u, -v}, {u, v}, {-u, v}}, {}});
  outline.area_m2 = width_m * height_m;
  return outline;
}

DescribedPlane described(const PlaneRecord& record, const Outline& outline, PlaneClass plane_class) {
  return {std::make_shared<const PlaneRecord>(record), std::make_shared<const Outline>(outline), plane_class};
}

RandomMap map_of(std::vector<DescribedPlane> planes, MapSnapshot::Parts parts) {
  if (parts.cell_size_m == 0.0) parts.cell_size_m = 0.1;
  for (const DescribedPlane& plane : planes) parts.planes.push_back(plane.record);
  return {std::make_shared<const MapSnapshot>(std::move(parts)), std::move(planes)};
}

RandomMap random_map(Random& random, int planes, int cells) {
  std::vector<DescribedPlane> described_planes;
  for (int i = 0; i < planes; ++i) described_planes.push_back(random_plane(random, static_cast<PlaneId>(2 * i + 1)));
  MapSnapshot::Parts parts;
  parts.cell_size_m = random.one_in(2) ? 0.1 : 0.25;
  parts.density_threshold = 10;
  std::map<std::tuple<int, int, int>, std::shared_ptr<Block>> blocks;
  for (int i = 0; i < cells; ++i) {
    const Vector3d p_m = random.in_cube(random.one_in(2) ? 1.0 : 3.0);
    const CellIndex index = (p_m / parts.cell_size_m).array().floor().matrix().cast<int>();
    const BlockIndex b = block_of(index);
    auto& block = blocks.try_emplace({b.x(), b.y(), b.z()}, nullptr).first->second;
    if (!block) block = std::make_shared<Block>(b);
    Cell& cell = block->cell(static_cast<std::size_t>(block->find_or_add(place_of(index))));
    cell.sums.count = random.one_in(4) ? 10.0 : 11.0 + random.below(100);
    cell.sums.first_m = cell.sums.count * random.in_cube(0.7 * parts.cell_size_m);
    cell.sums.error_m2 = Eigen::Vector3f::Constant(static_cast<float>(random.uniform(1e-4, 1e-2)));
    if (random.one_in(2)) cell.normal = random.unit().cast<float>();
    if (planes > 0 && random.one_in(2)) cell.plane = static_cast<PlaneSlot>(2 * random.below(planes) + 1);
  }
  for (auto& entry : blocks) parts.blocks.push_back(std::move(entry.second));
  return map_of(std::move(described_planes), std::move(parts));
}

Vector3d on_border(Random& random, const DescribedPlane& plane) {
  const Outline& outline = *plane.outline;
  if (outline.polygons.empty()) return plane.record->centroid_m;
  const Polygon& polygon =
      outline.polygons[static_cast<std::size_t>(random.below(static_cast<int>(outline.polygons.size())))];
  const Ring& ring = polygon.holes.empty() || random.one_in(2) ? polygon.outer : polygon.holes.front();
  const auto i = static_cast<std::size_t>(random.below(static_cast<int>(ring.size())));
  const double share = random.one_in(3) ? 0.0 : random.uniform(0.0, 1.0);  // 0: a corner
  return outline.basis.to_world((1.0 - share) * ring[i] + share * ring[(i + 1) % ring.size()]);
}

PlaneFilter random_filter(Random& random) {
  PlaneFilter filter;
  if (random.one_in(3)) filter.classes = {static_cast<PlaneClass>(random.below(6)), PlaneClass::kWall};
  if (random.one_in(3)) filter.min_area_m2 = random.uniform(0.0, 3.0);
  if (random.one_in(3)) filter.max_normal_deviation_rad = random.uniform(0.0, 0.02);
  if (random.one_in(3)) filter.seen_since_utime = 1000 + random.below(1000);
  if (random.one_in(3)) filter.epoch = 0;
  return filter;
}

bool passes(const DescribedPlane& plane, const PlaneFilter& filter) {
  const auto& classes = filter.classes;
  if (!classes.empty() && std::count(classes.begin(), classes.end(), plane.plane_class) == 0) return false;
  if (plane.outline->area_m2 < filter.min_area_m2) return false;
  if (normal_deviation_rad(*plane.record) > filter.max_normal_deviation_rad) return false;
  return plane.record->last_seen_utime >= filter.seen_since_utime;
}

bool passes(const CellView& cell, const RandomMap& map, const PlaneFilter& filter) {
  for (const DescribedPlane& plane : map.planes) {
    if (plane.record->id == cell.plane_id) return passes(plane, filter);
  }
  return filter.classes.empty() && filter.min_area_m2 == 0.0 && std::isinf(filter.max_normal_deviation_rad) &&
         filter.seen_since_utime < 0;
}

}  // namespace planemap::testing

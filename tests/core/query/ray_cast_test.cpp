#include "planemap/query/ray_cast.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <planemap/block.hpp>
#include <planemap/query/limits.hpp>
#include <planemap/query/snapshot_queries.hpp>
#include <utility>
#include <vector>

#include "query/boost_surface.hpp"
#include "query/random_map.hpp"

namespace planemap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::described;
using testing::record_of;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A wall x = 2, 2 m by 2 m about (2, 0, 0), seen from the origin's side.
testing::RandomMap wall(double offset_m = 0.0, double tilt_rad = 0.0) {
  const PlaneRecord record = record_of(7, {2.0, 0.0, 0.0}, -Vector3d::UnitX(), offset_m, tilt_rad);
  return testing::map_of({described(record, testing::rectangle(record, 2.0, 2.0))});
}

RayHits cast_one(const testing::RandomMap& map, const Ray& ray, const CastOptions& options = {}) {
  const auto hits = map.queries().cast(std::span(&ray, 1), options);
  EXPECT_TRUE(hits.has_value()) << hits.error().message;
  EXPECT_EQ(hits->size(), 1U);
  return hits->front();
}

TEST(Cast, SaysRangeAngleAndSide) {
  const RayHits hits = cast_one(wall(0.003, 0.002), {{0.0, 0.0, 0.0}, {4.0, 1.0, 0.0}});
  ASSERT_TRUE(hits.plane.has_value());
  EXPECT_EQ(hits.plane->id, 7U);
  EXPECT_NEAR(hits.plane->range_m, std::hypot(2.0, 0.5), 1e-12);
  EXPECT_TRUE(hits.plane->point_m.isApprox(Vector3d(2.0, 0.5, 0.0), 1e-12));
  EXPECT_NEAR(hits.plane->incidence_rad, std::atan2(1.0, 4.0), 1e-12);
  EXPECT_FALSE(hits.plane->from_behind);
  // 3 mm, and 2 mrad at 0.5 m from the centroid, along the normal; along the ray by 1 / cos more.
  EXPECT_NEAR(hits.plane->sigma_m, std::hypot(0.003, 0.001) * std::hypot(4.0, 1.0) / 4.0, 1e-12);
  EXPECT_FALSE(hits.cell.has_value());

  const RayHits behind = cast_one(wall(), {{5.0, 0.0, 0.0}, {-0.1, 0.0, 0.0}});
  ASSERT_TRUE(behind.plane.has_value());
  EXPECT_TRUE(behind.plane->from_behind);
  EXPECT_NEAR(behind.plane->range_m, 3.0, 1e-12);
  EXPECT_NEAR(behind.plane->incidence_rad, 0.0, 1e-6);
}

TEST(Cast, MeetsTheBorderButNothingBesideBehindOrTooFar) {
  const auto meets = [](const Ray& ray) { return cast_one(wall(), ray).plane.has_value(); };
  EXPECT_TRUE(meets({{0.0, 1.0, 0.0}, Vector3d::UnitX()}));
  EXPECT_TRUE(meets({{0.0, -1.0, 1.0}, Vector3d::UnitX()}));
  EXPECT_FALSE(meets({{0.0, 1.0 + 1e-6, 0.0}, Vector3d::UnitX()}));
  EXPECT_FALSE(meets({{0.0, 0.0, 0.0}, -Vector3d::UnitX()}));
  EXPECT_TRUE(meets({{0.0, 0.0, 0.0}, Vector3d::UnitX(), 2.0}));
  EXPECT_FALSE(meets({{0.0, 0.0, 0.0}, Vector3d::UnitX(), 1.999}));
  EXPECT_TRUE(meets({{2.0, 0.0, 0.0}, Vector3d::UnitX()}));    // begins on it
  EXPECT_FALSE(meets({{2.0, -3.0, 0.0}, Vector3d::UnitY()}));  // edge-on
  EXPECT_TRUE(meets({{0.0, 0.0, 0.0}, {1e-300, 0.0, 0.0}}));   // of any length
  EXPECT_TRUE(meets({{0.0, 0.0, 0.0}, {1e300, 1e290, 0.0}}));
}

/// One dense cell of 100 points, the cube of 0.1 m from (1, 0, 0).
testing::RandomMap one_cell(const Eigen::Vector3f& normal = Eigen::Vector3f::Zero()) {
  MapSnapshot::Parts parts;
  parts.cell_size_m = 0.1;
  parts.density_threshold = 10;
  auto block = std::make_shared<Block>(block_of(CellIndex(10, 0, 0)));
  Cell& cell = block->cell(static_cast<std::size_t>(block->find_or_add(place_of({10, 0, 0}))));
  cell.sums.count = 100.0;
  cell.sums.first_m = {2.0, 0.0, 0.0};                     // centre at (1.07, 0.05, 0.05)
  cell.sums.error_m2 = Eigen::Vector3f(9.0F, 4.0F, 1.0F);  // 3, 2 and 1 cm
  cell.normal = normal;
  parts.blocks.push_back(std::move(block));
  return testing::map_of({}, std::move(parts));
}

TEST(Cast, ACellIsMetInItsCubeAndMeasuredAtItsCentre) {
  const RayHits hits = cast_one(one_cell(-Eigen::Vector3f::UnitX()), {{0.0, 0.02, 0.02}, {2.0, 0.0, 0.0}});
  ASSERT_TRUE(hits.cell.has_value());
  EXPECT_NEAR(hits.cell->entry_m, 1.0, 1e-12);
  EXPECT_NEAR(hits.cell->range_m, 1.07, 1e-12);
  EXPECT_NEAR(hits.cell->sigma_m, 0.03, 1e-7);
  EXPECT_EQ(hits.cell->cell.count, 100U);
  ASSERT_TRUE(hits.cell->incidence_rad.has_value());
  EXPECT_NEAR(*hits.cell->incidence_rad, 0.0, 1e-6);

  const RayHits aslant = cast_one(one_cell(), {{1.05, -1.0, 0.05}, {0.0, 3.0, 0.0}});
  ASSERT_TRUE(aslant.cell.has_value());
  EXPECT_NEAR(aslant.cell->sigma_m, 0.02, 1e-7);
  EXPECT_FALSE(aslant.cell->incidence_rad.has_value());
  EXPECT_FALSE(cast_one(one_cell(), {{0.0, 0.12, 0.02}, Vector3d::UnitX()}).cell.has_value());
  EXPECT_EQ(cast_one(one_cell(), {{1.01, 0.02, 0.02}, Vector3d::UnitX()}).cell->entry_m, 0.0);
  EXPECT_FALSE(cast_one(one_cell(), {{0.0, 0.02, 0.02}, Vector3d::UnitX(), 0.99}).cell.has_value());
}

TEST(Cast, OptionsLeaveOutPlanesOrCells) {
  testing::Random random(3);
  const auto map = testing::random_map(random, 40, 4000);
  const Ray ray{{-6.0, 0.1, 0.2}, Vector3d::UnitX()};
  CastOptions options;
  ASSERT_TRUE(cast_one(map, ray).cell.has_value());
  options.cells = false;
  EXPECT_FALSE(cast_one(map, ray, options).cell.has_value());
  options.planes = false;
  EXPECT_FALSE(cast_one(map, ray, options).plane.has_value());
}

TEST(Cast, AnEmptyMapStopsNoRay) {
  const RayHits hits = cast_one(testing::map_of({}), Ray{});
  EXPECT_FALSE(hits.plane.has_value());
  EXPECT_FALSE(hits.cell.has_value());
  EXPECT_TRUE(testing::map_of({}).queries().cast({})->empty());
}

/// What a ray meets or may meet, worked out for one thing alone.
struct Meeting {
  double range_m = kInfinity;
  double tolerance_m = 1e-9;
  bool sure = false;  ///< else rounding decides
};

Meeting meeting(const Ray& ray, const DescribedPlane& plane, const testing::BoostSurface& surface) {
  const Vector3d direction = ray.direction.normalized();
  const double cosine = std::abs(plane.record->plane.normal().dot(direction));
  if (surface.empty() || cosine < kLeastCosine) return {};
  const PlaneBasis& basis = plane.outline->basis;
  Eigen::Matrix3d axes;  // origin + range direction = basis origin + u axis_u + v axis_v
  axes << -direction, basis.axis_u, basis.axis_v;
  const Vector3d solved = axes.fullPivLu().solve(ray.origin_m - basis.origin_m);
  Meeting met;
  met.range_m = solved[0];
  met.tolerance_m = 1e-9 + 1e-13 * (1.0 + std::abs(solved[0])) / cosine;
  const Vector2d uv_m = solved.tail<2>();
  const double blur_m = 1e-8 + 10.0 * met.tolerance_m;
  if (met.range_m < -blur_m || met.range_m > ray.max_range_m + blur_m || surface.distance_m(uv_m) > blur_m) return {};
  const bool in_range = met.range_m > met.tolerance_m && met.range_m < ray.max_range_m - met.tolerance_m;
  const bool on_surface = surface.distance_m(uv_m) <= 1e-12 || surface.border_distance_m(uv_m) <= 1e-12;
  met.sure = in_range && on_surface && (surface.border_distance_m(uv_m) > blur_m || met.tolerance_m < 2e-9);
  return met;
}

Meeting meeting(const Ray& ray, const Vector3d& low_m, double edge_m) {
  const Vector3d direction = ray.direction.normalized();
  double entry_m = 0.0;
  double exit_m = ray.max_range_m;
  bool on_face = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = low_m[axis] - ray.origin_m[axis];
    const double b = a + edge_m;
    if (direction[axis] == 0.0) {
      if (a > 1e-9 || b < -1e-9) return {};
      on_face = on_face || std::abs(a) <= 1e-9 || std::abs(b) <= 1e-9;
      continue;
    }
    entry_m = std::max(entry_m, std::min(a / direction[axis], b / direction[axis]));
    exit_m = std::min(exit_m, std::max(a / direction[axis], b / direction[axis]));
  }
  if (entry_m > exit_m + 1e-9) return {};
  return {entry_m, 1e-9, exit_m > entry_m + 1e-9 && !on_face};
}

/// Whether a hit, or none, is what the meetings allow: `at` is the place of what was hit.
void expect_first(const std::vector<Meeting>& meetings, const std::optional<std::size_t>& at, double range_m) {
  const double limit_m = at ? range_m : kInfinity;
  for (const Meeting& met : meetings) {
    ASSERT_TRUE(!met.sure || limit_m <= met.range_m + met.tolerance_m) << limit_m << " " << met.range_m;
  }
  if (!at) return;
  ASSERT_LT(meetings[*at].range_m, kInfinity);
  ASSERT_NEAR(range_m, std::max(meetings[*at].range_m, 0.0), 2.0 * meetings[*at].tolerance_m);
}

Ray random_ray(testing::Random& random, const testing::RandomMap& map) {
  Ray ray{random.in_cube(random.one_in(20) ? 500.0 : 6.0), random.unit()};
  if (random.one_in(3)) ray.max_range_m = random.uniform(0.1, 8.0);
  if (random.one_in(4)) {  // along an axis, maybe along the faces of cells
    ray.direction = (random.one_in(2) ? 1.0 : -1.0) * Vector3d::Unit(random.below(3));
    const double edge_m = map.snapshot->cell_size_m();
    if (random.one_in(2)) ray.origin_m = (ray.origin_m / edge_m).array().round().matrix() * edge_m;
  }
  if (map.planes.empty()) return ray;
  const DescribedPlane& plane = map.planes[static_cast<std::size_t>(random.below(static_cast<int>(map.planes.size())))];
  const PlaneBasis& basis = plane.outline->basis;
  const Vector3d border_m = testing::on_border(random, plane);
  switch (random.below(6)) {
    case 0:  // at the border
      ray.direction = border_m - ray.origin_m;
      break;
    case 1:  // edge-on
      ray.origin_m = border_m - 2.0 * basis.axis_u;
      ray.direction = basis.axis_u + random.uniform(-1.0, 1.0) * basis.axis_v;
      break;
    case 2:  // begins on a surface
      ray.origin_m = border_m;
      break;
    case 3:  // at a surface
      ray.direction = basis.to_world({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)}) - ray.origin_m;
      break;
    case 4:  // where most cells are
      ray.direction = random.in_cube(1.0) - ray.origin_m;
      break;
    default:
      break;
  }
  ray.direction *= random.uniform(0.1, 10.0);
  return ray;
}

TEST(Cast, AgreesWithEachPlaneAndCellAskedAloneOnRandomMaps) {
  testing::Random random(21);
  int cases = 0;
  int plane_hits = 0;
  int cell_hits = 0;
  for (int round = 0; round < 1000; ++round) {
    const auto map = testing::random_map(random, round % 50, round % 7 * 100);
    const SnapshotQueries queries = map.queries();
    std::vector<testing::BoostSurface> surfaces;
    for (const DescribedPlane& plane : map.planes) surfaces.emplace_back(*plane.outline);
    std::vector<CellView> cells;
    std::vector<Vector3d> corners_m;
    const double edge_m = map.snapshot->cell_size_m();
    for (const auto& block : map.snapshot->blocks()) {
      for (std::size_t i = 0; i < block->size(); ++i) {
        if (block->cell(i).sums.count <= 10.0) continue;
        cells.push_back(map.snapshot->view_of(*block, i));
        corners_m.emplace_back(block->cell_index(i).cast<double>() * edge_m);
      }
    }
    CastOptions options;
    if (round % 3 == 0) options.filter = testing::random_filter(random);
    std::vector<Ray> rays;
    for (int i = 0; i < 100; ++i) rays.push_back(random_ray(random, map));
    const auto hits = queries.cast(rays, options);
    ASSERT_TRUE(hits.has_value()) << hits.error().message;
    ASSERT_EQ(hits->size(), rays.size());
    for (std::size_t r = 0; r < rays.size(); ++r, ++cases) {
      const RayHits& hit = (*hits)[r];
      std::vector<Meeting> of_planes(map.planes.size());
      std::optional<std::size_t> plane_at;
      for (std::size_t i = 0; i < map.planes.size(); ++i) {
        if (testing::passes(map.planes[i], options.filter)) of_planes[i] = meeting(rays[r], map.planes[i], surfaces[i]);
        if (hit.plane && map.planes[i].record->id == hit.plane->id) plane_at = i;
      }
      ASSERT_EQ(plane_at.has_value(), hit.plane.has_value());
      ASSERT_NO_FATAL_FAILURE(expect_first(of_planes, plane_at, hit.plane ? hit.plane->range_m : 0.0));
      std::vector<Meeting> of_cells(cells.size());
      std::optional<std::size_t> cell_at;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        of_cells[i] = meeting(rays[r], corners_m[i], edge_m);
        if (of_cells[i].range_m < kInfinity && !testing::passes(cells[i], map, options.filter)) of_cells[i] = {};
        if (hit.cell && cells[i].centre_m == hit.cell->cell.centre_m) cell_at = i;
      }
      ASSERT_EQ(cell_at.has_value(), hit.cell.has_value());
      ASSERT_NO_FATAL_FAILURE(expect_first(of_cells, cell_at, hit.cell ? hit.cell->entry_m : 0.0));
      plane_hits += hit.plane ? 1 : 0;
      cell_hits += hit.cell ? 1 : 0;
    }
  }
  EXPECT_EQ(cases, 100'000);
  EXPECT_GT(plane_hits, 24'000);
  EXPECT_GT(cell_hits, 8'000);
}

TEST(Cast, TheStandardDeviationIsThatOfDrawnPlanes) {
  testing::Random random(22);
  for (int round = 0; round < 20; ++round) {
    const PlaneRecord record =
        record_of(1, random.in_cube(5.0), random.unit(), random.uniform(0.001, 0.02), random.uniform(0.001, 0.01));
    const auto map = testing::map_of({described(record, testing::rectangle(record, 4.0, 4.0))});
    const PlaneBasis basis = basis_of(record.plane, record.centroid_m);
    const Vector3d target_m = basis.to_world({random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)});
    const double incidence_rad = 1.2 * round / 19.0;  // square on to 69 degrees
    const Vector3d direction = std::sin(incidence_rad) * basis.axis_u - std::cos(incidence_rad) * record.plane.normal();
    const Ray ray{target_m - 3.0 * direction, direction};
    const RayHits hits = cast_one(map, ray);
    ASSERT_TRUE(hits.plane.has_value());
    EXPECT_NEAR(hits.plane->incidence_rad, incidence_rad, 1e-6);

    Eigen::Vector4d coefficients;
    coefficients << record.plane.normal(), record.plane.d();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(record.covariance);
    const Eigen::Matrix4d root = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    constexpr int kDraws = 40'000;  // their standard deviation is good to 0.35 %
    double sum = 0.0;
    double sum2 = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector4d z(random.normal(), random.normal(), random.normal(), random.normal());
      const Eigen::Vector4d drawn = coefficients + root * z;
      const double range_m = -drawn.dot(ray.origin_m.homogeneous()) / drawn.head<3>().dot(direction);
      sum += range_m;
      sum2 += range_m * range_m;
    }
    const double spread_m = std::sqrt(sum2 / kDraws - (sum / kDraws) * (sum / kDraws));
    EXPECT_NEAR(hits.plane->sigma_m / spread_m, 1.0, 0.03) << round;
  }
}

/// A dense cell about a place, of points with random errors of their own.
struct RandomCell {
  MapSnapshot::Parts parts;
  std::vector<Vector3d> points_m;
  std::vector<Vector3d> sigmas_m;
};

RandomCell random_cell(testing::Random& random) {
  constexpr int kPoints = 12;
  constexpr double kEdgeM = 0.1;
  RandomCell made;
  made.parts.cell_size_m = kEdgeM;
  made.parts.density_threshold = 10;
  const CellIndex index = (random.in_cube(5.0) / kEdgeM).array().floor().matrix().cast<int>();
  const Vector3d middle_m = kEdgeM * (index.cast<double>() + Vector3d::Constant(0.5));
  auto block = std::make_shared<Block>(block_of(index));
  Cell& cell = block->cell(static_cast<std::size_t>(block->find_or_add(place_of(index))));
  const Vector3d largest_m(random.uniform(0.001, 0.05), random.uniform(0.001, 0.05), random.uniform(0.001, 0.05));
  for (int i = 0; i < kPoints; ++i) {
    made.points_m.push_back(middle_m + random.in_cube(0.5 * kEdgeM));
    made.sigmas_m.push_back(random.uniform(0.2, 1.0) * largest_m);
    cell.sums.count += 1.0;
    cell.sums.first_m += made.points_m.back() - middle_m;
    cell.sums.error_m2 += made.sigmas_m.back().cwiseAbs2().cast<float>();
  }
  made.parts.blocks.push_back(std::move(block));
  return made;
}

TEST(Cast, TheStandardDeviationOfACellIsThatOfDrawnPoints) {
  testing::Random random(23);
  for (int round = 0; round < 10; ++round) {
    RandomCell made = random_cell(random);
    Vector3d centre_m = Vector3d::Zero();
    for (const Vector3d& p_m : made.points_m) centre_m += p_m / static_cast<double>(made.points_m.size());
    const Vector3d direction = random.unit();
    // Passes the cube's middle, not the centre itself.
    const auto map = testing::map_of({}, std::move(made.parts));
    const Vector3d middle_m = 0.1 * ((centre_m / 0.1).array().floor().matrix() + Vector3d::Constant(0.5));
    const Ray ray{middle_m - 3.0 * direction, 2.5 * direction};
    const RayHits hits = cast_one(map, ray);
    ASSERT_TRUE(hits.cell.has_value()) << round;

    constexpr int kDraws = 40'000;  // their standard deviation is good to 0.35 %
    double sum = 0.0;
    double sum2 = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      Vector3d drawn_m = Vector3d::Zero();
      for (std::size_t j = 0; j < made.points_m.size(); ++j) {
        drawn_m += made.points_m[j] + made.sigmas_m[j].cwiseProduct(random.normals());
      }
      drawn_m /= static_cast<double>(made.points_m.size());
      const double range_m = direction.dot(drawn_m - ray.origin_m);  // where the ray passes nearest to it
      sum += range_m;
      sum2 += range_m * range_m;
    }
    const double mean_m = sum / kDraws;
    const double spread_m = std::sqrt(sum2 / kDraws - mean_m * mean_m);
    EXPECT_NEAR(hits.cell->range_m, mean_m, 5.0 * spread_m / std::sqrt(kDraws)) << round;
    EXPECT_NEAR(hits.cell->sigma_m / spread_m, 1.0, 0.03) << round;
  }
}

}  // namespace
}  // namespace planemap

#include "planemap/query/nearest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <planemap/query/snapshot_queries.hpp>

#include "query/boost_surface.hpp"
#include "query/random_map.hpp"

namespace planemap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::described;
using testing::record_of;

/// A wall x = 2 of 2 m by 2 m about (2, 0, 1), seen from the origin's side, with a window of 1 m by 1 m in its middle.
testing::RandomMap wall_with_window(double offset_m = 0.0, double tilt_rad = 0.0) {
  const PlaneRecord record = record_of(7, {2.0, 0.0, 1.0}, -Vector3d::UnitX(), offset_m, tilt_rad);
  Outline outline = testing::rectangle(record, 2.0, 2.0);
  outline.polygons[0].holes.push_back({{-0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}});
  return testing::map_of({described(record, outline)});
}

NearPlane nearest_one(const testing::RandomMap& map, const NearestQuery& query) {
  const auto found = map.queries().nearest(query);
  EXPECT_TRUE(found.has_value()) << found.error().message;
  EXPECT_EQ(found->size(), 1U);
  return found->front();
}

TEST(Nearest, MeasuresToTheSurfaceAndToThePlane) {
  const auto map = wall_with_window();
  NearestQuery query;
  query.point_m = {1.5, 0.7, 1.0};  // before the wall
  NearPlane near = nearest_one(map, query);
  EXPECT_EQ(near.id, 7U);
  EXPECT_NEAR(near.surface_distance_m, 0.5, 1e-12);
  EXPECT_NEAR(near.signed_distance_m, 0.5, 1e-12);
  EXPECT_TRUE(near.foot_m.isApprox(Vector3d(2.0, 0.7, 1.0), 1e-12));
  EXPECT_TRUE(near.foot_inside);

  query.point_m = {2.3, 0.0, 1.1};  // behind the window: 0.4 m from its upper side
  near = nearest_one(map, query);
  EXPECT_NEAR(near.signed_distance_m, -0.3, 1e-12);
  EXPECT_NEAR(near.surface_distance_m, 0.5, 1e-12);
  EXPECT_TRUE(near.surface_point_m.isApprox(Vector3d(2.0, 0.0, 1.5), 1e-12));
  EXPECT_TRUE(near.foot_m.isApprox(Vector3d(2.0, 0.0, 1.1), 1e-12));
  EXPECT_FALSE(near.foot_inside);

  query.point_m = {2.0, 4.0, 6.0};  // edge-on, 3 m and 4 m beside a corner
  near = nearest_one(map, query);
  EXPECT_NEAR(near.signed_distance_m, 0.0, 1e-12);
  EXPECT_NEAR(near.surface_distance_m, 5.0, 1e-12);
  EXPECT_FALSE(near.foot_inside);
}

TEST(Nearest, TheBorderIsInside) {
  const auto map = wall_with_window();
  for (const Vector3d& p_m : {Vector3d(1.0, 1.0, 1.3), Vector3d(1.0, -1.0, 2.0), Vector3d(1.0, 0.5, 1.0)}) {
    NearestQuery query;
    query.point_m = p_m;
    const NearPlane near = nearest_one(map, query);
    EXPECT_TRUE(near.foot_inside) << p_m.transpose();
    EXPECT_NEAR(near.surface_distance_m, 1.0, 1e-12);
  }
}

TEST(Nearest, TheStandardDeviationHasPlaneAndPointInIt) {
  // 3 mm of the plane's offset, 2 mrad at 1.5 m and at 2 m from the centroid, 4 mm of the point along the normal.
  NearestQuery query;
  query.point_m = {1.0, 1.5, 3.0};
  query.covariance_m2 = Vector3d(16e-6, 1e-12, 1e-12).asDiagonal();
  const NearPlane near = nearest_one(wall_with_window(0.003, 0.002), query);
  const double expected_m = std::sqrt(9e-6 + 4e-6 * (1.5 * 1.5 + 2.0 * 2.0) + 16e-6 + 2.0 * 4e-6 * 1e-12);
  EXPECT_NEAR(near.sigma_m, expected_m, 1e-9);
  EXPECT_NEAR(near.mahalanobis, 1.0 / expected_m, 1e-3);
}

TEST(Nearest, WithoutAnyErrorTheMahalanobisDistanceIsZeroOrInfinite) {
  NearestQuery query;
  query.point_m = {1.0, 0.7, 1.0};
  EXPECT_EQ(nearest_one(wall_with_window(), query).mahalanobis, std::numeric_limits<double>::infinity());
  query.point_m.x() = 2.0;
  EXPECT_EQ(nearest_one(wall_with_window(), query).mahalanobis, 0.0);
}

TEST(Nearest, EquallyNearOnesComeByIdAndNoMoreThanAskedFor) {
  std::vector<DescribedPlane> planes;
  for (const PlaneId id : {3U, 5U, 8U, 9U}) {
    const PlaneRecord record = record_of(id, {2.0, 0.0, 1.0}, Vector3d::UnitX(), 0.0, 0.0);
    planes.push_back(described(record, testing::rectangle(record, 1.0, 1.0)));
  }
  const auto map = testing::map_of(planes);
  NearestQuery query;
  query.count = 3;
  const auto found = map.queries().nearest(query);
  ASSERT_EQ(found->size(), 3U);
  EXPECT_EQ((*found)[0].id, 3U);
  EXPECT_EQ((*found)[1].id, 5U);
  EXPECT_EQ((*found)[2].id, 8U);
  query.count = 100;
  EXPECT_EQ(map.queries().nearest(query)->size(), 4U);
  query.max_distance_m = 1.0;
  EXPECT_TRUE(map.queries().nearest(query)->empty());
}

TEST(Nearest, AnEmptyMapHasNoPlanes) {
  EXPECT_TRUE(testing::map_of({}).queries().nearest(NearestQuery{})->empty());
}

struct Twin {
  double distance_m;
  PlaneId id;
  bool inside;
};

/// All planes that may be named, nearest first: each one's surface asked through Boost.Geometry.
std::vector<Twin> nearest_by_hand(const testing::RandomMap& map, const std::vector<testing::BoostSurface>& surfaces,
                                  const NearestQuery& query) {
  std::vector<Twin> all;
  for (std::size_t i = 0; i < map.planes.size(); ++i) {
    if (surfaces[i].empty() || !testing::passes(map.planes[i], query.filter)) continue;
    const Plane& plane = map.planes[i].record->plane;
    const double off_m = plane.normal().dot(query.point_m) + plane.d();
    const Vector2d foot_m = map.planes[i].outline->basis.to_plane(query.point_m - off_m * plane.normal());
    const double beside_m = surfaces[i].distance_m(foot_m);
    all.push_back({std::hypot(off_m, beside_m), map.planes[i].record->id, beside_m == 0.0});
  }
  std::sort(all.begin(), all.end(), [](const Twin& a, const Twin& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.id < b.id;
  });
  return all;
}

Vector3d random_point(testing::Random& random, const testing::RandomMap& map) {
  if (map.planes.empty() || random.one_in(3)) return random.in_cube(random.one_in(10) ? 1000.0 : 6.0);
  const DescribedPlane& plane = map.planes[static_cast<std::size_t>(random.below(static_cast<int>(map.planes.size())))];
  const Vector3d on_border_m = testing::on_border(random, plane);
  const PlaneBasis& basis = plane.outline->basis;
  switch (random.below(4)) {
    case 0:  // on the border
      return on_border_m;
    case 1:  // the foot is on the border
      return on_border_m + random.uniform(-1.0, 1.0) * plane.record->plane.normal();
    case 2:  // edge-on
      return on_border_m + random.uniform(-1.0, 1.0) * basis.axis_u + random.uniform(-1.0, 1.0) * basis.axis_v;
    default:
      return on_border_m + 0.3 * random.normals();
  }
}

TEST(Nearest, AgreesWithBoostGeometryOnRandomMaps) {
  constexpr double kTolerance = 4e-9;  // what counts as on the border may
  testing::Random random(11);
  int cases = 0;
  int named = 0;
  for (int round = 0; round < 1000; ++round) {
    const auto map = testing::random_map(random, round % 50, 0);
    const SnapshotQueries queries = map.queries();
    std::vector<testing::BoostSurface> surfaces;
    for (const DescribedPlane& plane : map.planes) surfaces.emplace_back(*plane.outline);
    for (int i = 0; i < 100; ++i, ++cases) {
      NearestQuery query;
      query.point_m = random_point(random, map);
      query.count = static_cast<std::size_t>(1 + random.below(5));
      if (random.one_in(3)) query.max_distance_m = random.uniform(0.0, 3.0);
      if (random.one_in(3)) query.filter = testing::random_filter(random);
      const auto found = queries.nearest(query);
      ASSERT_TRUE(found.has_value()) << found.error().message;
      const auto all = nearest_by_hand(map, surfaces, query);
      const auto within = [&](double limit_m) {
        return static_cast<std::size_t>(
            std::count_if(all.begin(), all.end(), [&](const Twin& t) { return t.distance_m <= limit_m; }));
      };
      ASSERT_GE(found->size(), std::min(query.count, within(query.max_distance_m - kTolerance)));
      ASSERT_LE(found->size(), std::min(query.count, within(query.max_distance_m + kTolerance)));
      for (std::size_t k = 0; k < found->size(); ++k, ++named) {
        const NearPlane& near = (*found)[k];
        ASSERT_NEAR(near.surface_distance_m, all[k].distance_m, kTolerance);
        const auto twin = std::find_if(all.begin(), all.end(), [&](const Twin& t) { return t.id == near.id; });
        ASSERT_NE(twin, all.end());
        ASSERT_NEAR(near.surface_distance_m, twin->distance_m, kTolerance);
        ASSERT_NEAR((near.surface_point_m - query.point_m).norm(), near.surface_distance_m, kTolerance);
        ASSERT_TRUE(near.foot_inside || !twin->inside);
        ASSERT_TRUE(!near.foot_inside || twin->distance_m <= std::abs(near.signed_distance_m) + kTolerance);
      }
    }
  }
  EXPECT_EQ(cases, 100'000);
  EXPECT_GT(named, 160'000);
}

/// Draws errors of (nx, ny, nz, d) or of points by their covariance.
template <int N>
Eigen::Matrix<double, N, 1> drawn(testing::Random& random, const Eigen::Matrix<double, N, N>& root) {
  Eigen::Matrix<double, N, 1> z;
  for (int i = 0; i < N; ++i) z[i] = random.normal();
  return root * z;
}

template <int N>
Eigen::Matrix<double, N, N> root_of(const Eigen::Matrix<double, N, N>& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

TEST(Nearest, TheStandardDeviationIsThatOfDrawnPlanesAndPoints) {
  testing::Random random(12);
  for (int round = 0; round < 20; ++round) {
    const PlaneRecord record =
        record_of(1, random.in_cube(5.0), random.unit(), random.uniform(0.001, 0.02), random.uniform(0.001, 0.02));
    const auto map = testing::map_of({described(record, testing::rectangle(record, 1.0, 1.0))});
    NearestQuery query;
    query.point_m = record.centroid_m + random.in_cube(2.0);
    query.covariance_m2 = random.covariance(round % 4 == 0 ? 0.2 : 0.02);
    if (round % 4 == 1) {  // known well across the plane and badly along it: what both errors make is nearly all
      const PlaneBasis basis = basis_of(record.plane, record.centroid_m);
      query.point_m = record.centroid_m;
      query.covariance_m2 = basis.axis_u * basis.axis_u.transpose() + basis.axis_v * basis.axis_v.transpose();
    }
    const double stated_m = nearest_one(map, query).sigma_m;

    Eigen::Vector4d coefficients;
    coefficients << record.plane.normal(), record.plane.d();
    const Eigen::Matrix4d plane_root = root_of<4>(record.covariance);
    const Eigen::Matrix3d point_root = root_of<3>(query.covariance_m2);
    constexpr int kDraws = 40'000;  // their standard deviation is good to 0.35 %
    double sum = 0.0;
    double sum2 = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector4d drawn_plane = coefficients + drawn<4>(random, plane_root);
      const Vector3d p_m = query.point_m + drawn<3>(random, point_root);
      const double distance_m = drawn_plane.dot(p_m.homogeneous()) / drawn_plane.head<3>().norm();
      sum += distance_m;
      sum2 += distance_m * distance_m;
    }
    const double spread_m = std::sqrt(sum2 / kDraws - (sum / kDraws) * (sum / kDraws));
    EXPECT_NEAR(stated_m / spread_m, 1.0, 0.03) << round;
  }
}

}  // namespace
}  // namespace planemap

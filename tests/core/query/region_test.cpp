#include "planemap/query/region.hpp"

#include <gtest/gtest.h>

#include <boost/geometry/algorithms/within.hpp>
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

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A floor z = 0 of 4 m by 4 m about the origin.
testing::RandomMap floor_map() {
  const PlaneRecord record = record_of(7, Vector3d::Zero(), Vector3d::UnitZ(), 0.001, 0.001);
  return testing::map_of({described(record, testing::rectangle(record, 4.0, 4.0), PlaneClass::kFloor)});
}

RegionContents contents(const testing::RandomMap& map, const Region& region) {
  RegionQuery query{region, true, true, {}};
  const auto found = map.queries().region(query);
  EXPECT_TRUE(found.has_value()) << found.error().message;
  query.polygons = false;
  EXPECT_EQ(map.queries().region(query)->planes.size(), found->planes.size());
  return *found;
}

/// What a region has of the floor, square metres; -1: it does not name it.
double floor_in(const Region& region) {
  const auto found = contents(floor_map(), region);
  return found.planes.empty() ? -1.0 : found.planes.front().area_m2;
}

Eigen::Isometry3d at(const Vector3d& p_m, const Eigen::Matrix3d& R = Eigen::Matrix3d::Identity()) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = p_m;
  return T;
}

TEST(Region, ABoxClipsTheFloor) {
  EXPECT_NEAR(floor_in(BoxRegion{{1.0, 1.0, -1.0}, {5.0, 1.5, 1.0}}), 0.5, 1e-6);
  EXPECT_NEAR(floor_in(BoxRegion{{-9.0, -9.0, -1.0}, {9.0, 9.0, 1.0}}), 16.0, 1e-9);
  EXPECT_EQ(floor_in(BoxRegion{{-9.0, -9.0, 0.1}, {9.0, 9.0, 1.0}}), -1.0);
  EXPECT_EQ(floor_in(BoxRegion{{2.1, -9.0, -1.0}, {9.0, 9.0, 1.0}}), -1.0);
  EXPECT_NEAR(floor_in(BoxRegion{{-9.0, -9.0, 0.0}, {9.0, 9.0, 1.0}}), 16.0, 1e-9);  // stands on it
  EXPECT_NEAR(floor_in(BoxRegion{{1.0, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}}), 4.0, 1e-6);
}

TEST(Region, SaysWhetherAllOfASurfaceIsInIt) {
  EXPECT_TRUE(contents(floor_map(), BoxRegion{{-2.0, -2.0, -1.0}, {2.0, 2.0, 1.0}}).planes.at(0).whole);
  EXPECT_FALSE(contents(floor_map(), BoxRegion{{-1.9, -2.0, -1.0}, {2.0, 2.0, 1.0}}).planes.at(0).whole);
}

TEST(Region, AnOrientedBoxClipsTheFloor) {
  const Eigen::Matrix3d eighth = Eigen::AngleAxisd(M_PI / 4.0, Vector3d::UnitZ()).matrix();
  EXPECT_NEAR(floor_in(OrientedBoxRegion{at({0.0, 0.0, 0.0}, eighth), {2.0, 1.0, 1.0}}), 2.0, 1e-6);
  EXPECT_NEAR(floor_in(OrientedBoxRegion{at({2.0, 2.0, 0.0}, eighth), {2.0, 2.0, 1.0}}), 1.0, 1e-6);  // a corner of it
}

TEST(Region, ASphereClipsTheFloorToADisc) {
  EXPECT_NEAR(floor_in(SphereRegion{{0.0, 0.0, 0.3}, 0.5}), M_PI * 0.16, 1e-6);
  EXPECT_NEAR(floor_in(SphereRegion{{2.0, 0.0, 0.3}, 0.5}), M_PI * 0.08, 1e-5);
  EXPECT_EQ(floor_in(SphereRegion{{0.0, 0.0, 0.3}, 0.29}), -1.0);
  EXPECT_EQ(floor_in(SphereRegion{{2.4, 2.4, 0.0}, 0.56}), -1.0);  // the corner is 0.566 m away
  EXPECT_GE(floor_in(SphereRegion{{2.4, 2.4, 0.0}, 0.57}), 0.0);
}

TEST(Region, ACylinderClipsTheFloor) {
  const double disc_m2 = M_PI * 0.25;
  EXPECT_NEAR(floor_in(CylinderRegion{{0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}, 0.5}), disc_m2, 1e-6);
  // Leaning by 45 degrees, it cuts the floor in an ellipse.
  EXPECT_NEAR(floor_in(CylinderRegion{{-1.0, 0.0, -1.0}, {1.0, 0.0, 1.0}, 0.5}), disc_m2 * std::sqrt(2.0), 1e-6);
  EXPECT_EQ(floor_in(CylinderRegion{{0.0, 0.0, 0.1}, {0.0, 0.0, 1.0}, 0.5}), -1.0);  // ends above it
  // Lying 0.3 m above it: a strip 0.8 m wide.
  EXPECT_NEAR(floor_in(CylinderRegion{{-1.0, 0.0, 0.3}, {0.5, 0.0, 0.3}, 0.5}), 1.5 * 0.8, 1e-6);
  EXPECT_EQ(floor_in(CylinderRegion{{-1.0, 0.0, 0.6}, {0.5, 0.0, 0.6}, 0.5}), -1.0);
}

TEST(Region, AFrustumSeesTheFloor) {
  Eigen::Matrix3d down;  // x right, y down: the camera's top is towards the world's y
  down << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
  const auto frustum = [&](double near_m, double far_m) {
    return FrustumRegion{at({0.0, 0.0, 2.0}, down), 2.0 * std::atan(0.5), 2.0 * std::atan(0.25), near_m, far_m};
  };
  EXPECT_NEAR(floor_in(frustum(0.0, 3.0)), 2.0 * 1.0, 1e-6);
  EXPECT_EQ(floor_in(frustum(0.0, 1.9)), -1.0);
  EXPECT_EQ(floor_in(frustum(2.1, 3.0)), -1.0);
}

TEST(Region, AnEmptyMapHasNothing) {
  const auto found = contents(testing::map_of({}), SphereRegion{Vector3d::Zero(), 1e6});
  EXPECT_TRUE(found.planes.empty());
  EXPECT_TRUE(found.cells.empty());
}

/// Whether a point is in a region, word by word, with that much of a margin.
bool is_in(const Vector3d& p_m, const Region& region, double margin_m) {
  if (const auto* box = std::get_if<BoxRegion>(&region)) {
    return ((p_m - box->min_m).array() >= -margin_m).all() && ((box->max_m - p_m).array() >= -margin_m).all();
  }
  if (const auto* box = std::get_if<OrientedBoxRegion>(&region)) {
    const Vector3d p_box_m = box->T_world_box.inverse() * p_m;
    return (p_box_m.cwiseAbs().array() <= 0.5 * box->size_m.array() + margin_m).all();
  }
  if (const auto* sphere = std::get_if<SphereRegion>(&region)) {
    return (p_m - sphere->centre_m).norm() <= sphere->radius_m + margin_m;
  }
  if (const auto* frustum = std::get_if<FrustumRegion>(&region)) {
    const Vector3d p_sensor_m = frustum->T_world_sensor.inverse() * p_m;
    const double depth_m = p_sensor_m.z() + margin_m;
    const double x = 0.5 * frustum->horizontal_rad;
    const double y = 0.5 * frustum->vertical_rad;
    return depth_m >= frustum->near_m && p_sensor_m.z() <= frustum->far_m + margin_m &&
           std::abs(p_sensor_m.x()) * std::cos(x) <= p_sensor_m.z() * std::sin(x) + margin_m &&
           std::abs(p_sensor_m.y()) * std::cos(y) <= p_sensor_m.z() * std::sin(y) + margin_m;
  }
  const auto& cylinder = std::get<CylinderRegion>(region);
  const Eigen::ParametrizedLine<double, 3> axis =
      Eigen::ParametrizedLine<double, 3>::Through(cylinder.from_m, cylinder.to_m);
  const double along_m = axis.direction().dot(p_m - cylinder.from_m);
  return axis.distance(p_m) <= cylinder.radius_m + margin_m && along_m >= -margin_m &&
         along_m <= (cylinder.to_m - cylinder.from_m).norm() + margin_m;
}

Region random_region(testing::Random& random, const testing::RandomMap& map, int kind) {
  Eigen::Isometry3d T = random.pose(4.0);
  if (random.one_in(5) && !map.planes.empty()) {  // along a plane
    const PlaneBasis& basis = map.planes.front().outline->basis;
    T.linear() << basis.axis_u, basis.axis_v, basis.axis_u.cross(basis.axis_v);
    T.translation() = basis.origin_m + random.uniform(-0.2, 0.2) * basis.axis_u;
  }
  const Vector3d size_m(random.uniform(0.2, 6.0), random.uniform(0.2, 6.0), random.uniform(0.2, 6.0));
  switch (kind) {
    case 0:
      return BoxRegion{T.translation() - 0.5 * size_m, T.translation() + 0.5 * size_m};
    case 1:
      return OrientedBoxRegion{T, size_m};
    case 2:
      return SphereRegion{T.translation(), 0.5 * size_m.x()};
    case 3:
      return FrustumRegion{T, random.uniform(0.1, 2.5), random.uniform(0.1, 2.5), random.one_in(2) ? 0.0 : 0.3,
                           size_m.x() + 0.3};
    default:
      return CylinderRegion{T.translation(), T.translation() + size_m.y() * T.linear().col(random.below(3)),
                            0.5 * size_m.x()};
  }
}

/// Points of a surface on a raster, and which of them are in a region.
struct Raster {
  int points = 0;
  int within = 0;
  int surely_within = 0;
  double point_m2 = 0.0;
};

Raster raster_of(const DescribedPlane& plane, const testing::BoostSurface& surface, const Region& region) {
  constexpr int kSide = 40;
  Eigen::AlignedBox2d box;
  for (const Polygon& polygon : plane.outline->polygons) {
    for (const Vector2d& p : polygon.outer) box.extend(p);
  }
  Raster raster;
  raster.point_m2 = box.volume() / (kSide * kSide);
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vector2d uv_m = box.min() + box.sizes().cwiseProduct(Vector2d(i % kSide + 0.5, i / kSide + 0.5) / kSide);
    if (!boost::geometry::within(testing::BoostSurface::Point(uv_m.x(), uv_m.y()), surface.polygons())) continue;
    const Vector3d p_m = plane.outline->basis.to_world(uv_m);
    ++raster.points;
    raster.within += is_in(p_m, region, 1e-9) ? 1 : 0;
    raster.surely_within += is_in(p_m, region, -1e-6) ? 1 : 0;
  }
  return raster;
}

TEST(Region, AgreesWithPointsOfTheSurfacesOnRandomMaps) {
  testing::Random random(41);
  int named = 0;
  int clipped = 0;
  int cells = 0;
  for (int round = 0; round < 1000; ++round) {
    const auto map = testing::random_map(random, 40, 200);
    RegionQuery query{random_region(random, map, round % 5), true, true, {}};
    if (random.one_in(4)) query.filter = testing::random_filter(random);
    const auto found = map.queries().region(query);
    ASSERT_TRUE(found.has_value()) << found.error().message;
    std::size_t next = 0;
    for (const DescribedPlane& plane : map.planes) {
      const bool is_named = next < found->planes.size() && found->planes[next].plane.record == plane.record;
      const RegionPlane* part = is_named ? &found->planes[next++] : nullptr;
      const testing::BoostSurface surface(*plane.outline);
      if (surface.empty() || !testing::passes(plane, query.filter)) {
        ASSERT_EQ(part, nullptr);
        continue;
      }
      const Raster raster = raster_of(plane, surface, query.region);
      if (part == nullptr) {
        ASSERT_EQ(raster.surely_within, 0) << round;
        continue;
      }
      ++named;
      clipped += part->whole ? 0 : 1;
      // Along borders the raster is off: by about the root of the number of points that lie there.
      const double blur_m2 = raster.point_m2 * (8.0 + 1.5 * std::sqrt(raster.points));
      ASSERT_NEAR(part->area_m2, raster.within * raster.point_m2, blur_m2) << round;
      if (part->whole) {
        ASSERT_EQ(raster.within, raster.points) << round;
      }
    }
    ASSERT_EQ(next, found->planes.size()) << "by id, each once";
    std::size_t cell = 0;
    map.snapshot->for_each_cell([&](const CellView& view) {
      if (!testing::passes(view, map, query.filter) || !is_in(view.centre_m, query.region, 1e-9)) return;
      ASSERT_LT(cell, found->cells.size());
      EXPECT_EQ(found->cells[cell++].centre_m, view.centre_m);
    });
    ASSERT_EQ(cell, found->cells.size());
    cells += static_cast<int>(cell);
  }
  EXPECT_GT(named, 2000);
  EXPECT_GT(clipped, 1200);
  EXPECT_GT(cells, 4000);
}

}  // namespace
}  // namespace planemap

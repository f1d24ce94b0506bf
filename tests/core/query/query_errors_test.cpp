// What each query says of arguments that make no sense: clients show these words to people.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <planemap/query/snapshot_queries.hpp>
#include <stdexcept>
#include <string>

#include "query/random_map.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const SnapshotQueries& queries() {
  static testing::Random random(61);
  static const SnapshotQueries made(testing::random_map(random, 10, 100).snapshot, -Vector3d::UnitZ());
  return made;
}

template <class Answer>
std::string message_of(const Answer& answer) {
  return answer ? "no error" : answer.error().message;
}

std::string nearest_with(void (*spoil)(NearestQuery&)) {
  NearestQuery query;
  spoil(query);
  return message_of(queries().nearest(query));
}

TEST(QueryErrors, OfNearest) {
  EXPECT_EQ(nearest_with([](auto&) {}), "no error");
  EXPECT_EQ(nearest_with([](auto& q) { q.point_m.y() = kNan; }), "point_m: not every coordinate is a finite number");
  EXPECT_EQ(nearest_with([](auto& q) { q.point_m.y() = -2e6; }),
            "point_m: coordinates may be at most 1e+06 m, one is 2e+06");
  EXPECT_EQ(nearest_with([](auto& q) { q.count = 0; }), "count: must be at least 1, is 0");
  EXPECT_EQ(nearest_with([](auto& q) { q.max_distance_m = -0.5; }), "max_distance_m: must be at least 0, is -0.5");
  EXPECT_EQ(nearest_with([](auto& q) { q.max_distance_m = kNan; }), "max_distance_m: must be at least 0, is nan");
  EXPECT_EQ(nearest_with([](auto& q) { q.covariance_m2(1, 1) = kInfinity; }),
            "covariance_m2: not every number is finite");
  EXPECT_EQ(nearest_with([](auto& q) { q.covariance_m2(0, 1) = 0.1; }), "covariance_m2: is not symmetric");
  EXPECT_EQ(nearest_with([](auto& q) { q.covariance_m2(2, 2) = -0.25; }),
            "covariance_m2: is not positive semi-definite: its least eigenvalue is -0.25");
}

std::string filtered_by(void (*spoil)(PlaneFilter&)) {
  NearestQuery nearest;
  spoil(nearest.filter);
  const std::string message = message_of(queries().nearest(nearest));
  CastOptions cast{true, true, nearest.filter};
  EXPECT_EQ(message_of(queries().cast({}, cast)), message);
  const RegionQuery region{SphereRegion{Vector3d::Zero(), 1.0}, false, false, nearest.filter};
  EXPECT_EQ(message_of(queries().region(region)), message);
  return message;
}

TEST(QueryErrors, OfFilters) {
  EXPECT_EQ(filtered_by([](auto& f) { f.epoch = 0; }), "no error");
  EXPECT_EQ(filtered_by([](auto& f) { f.epoch = 3; }), "filter.epoch: the map is of epoch 0, asked for is 3");
  EXPECT_EQ(filtered_by([](auto& f) { f.min_area_m2 = -1.0; }),
            "filter.min_area_m2: must be finite and at least 0, is -1");
  EXPECT_EQ(filtered_by([](auto& f) { f.max_normal_deviation_rad = kNan; }),
            "filter.max_normal_deviation_rad: must be at least 0, is nan");
}

std::string cast_with(void (*spoil)(Ray&)) {
  std::vector<Ray> rays(4);
  spoil(rays[3]);
  return message_of(queries().cast(rays));
}

TEST(QueryErrors, OfRays) {
  EXPECT_EQ(cast_with([](auto&) {}), "no error");
  EXPECT_EQ(cast_with([](auto& r) { r.origin_m.x() = kInfinity; }),
            "rays[3].origin_m: not every coordinate is a finite number");
  EXPECT_EQ(cast_with([](auto& r) { r.direction.setZero(); }), "rays[3].direction: must not be zero");
  EXPECT_EQ(cast_with([](auto& r) { r.direction.z() = kNan; }), "rays[3].direction: not every number is finite");
  EXPECT_EQ(cast_with([](auto& r) { r.max_range_m = 0.0; }), "rays[3].max_range_m: must be greater than 0, is 0");
  EXPECT_EQ(cast_with([](auto& r) { r.max_range_m = kNan; }), "rays[3].max_range_m: must be greater than 0, is nan");
}

std::string region_error(const Region& region) {
  return message_of(queries().region(RegionQuery{region, true, true, {}}));
}

TEST(QueryErrors, OfBoxesAndSpheres) {
  EXPECT_EQ(region_error(BoxRegion{{0.0, 0.0, 0.0}, {1.0, -1.0, 1.0}}),
            "box.min_m.y: must be less than max_m's -1, is 0");
  EXPECT_EQ(region_error(BoxRegion{{0.0, 0.0, kNan}, {1.0, 1.0, 1.0}}),
            "box.min_m.z: must be less than max_m's 1, is nan");
  EXPECT_EQ(region_error(OrientedBoxRegion{Eigen::Isometry3d::Identity(), {1.0, 1.0, 0.0}}),
            "oriented_box.size_m.z: must be greater than 0 and at most 1e+06 m, is 0");
  Eigen::Isometry3d mirrored = Eigen::Isometry3d::Identity();
  mirrored.linear()(0, 0) = -1.0;
  EXPECT_EQ(region_error(OrientedBoxRegion{mirrored, {1.0, 1.0, 1.0}}),
            "oriented_box.T_world_box: its upper left 3x3 is no rotation");
  EXPECT_EQ(region_error(SphereRegion{{0.0, 0.0, 0.0}, -1.0}),
            "sphere.radius_m: must be greater than 0 and at most 1e+06 m, is -1");
  EXPECT_EQ(region_error(SphereRegion{{0.0, kNan, 0.0}, 1.0}),
            "sphere.centre_m: not every coordinate is a finite number");
}

TEST(QueryErrors, OfFrustumsAndCylinders) {
  const FrustumRegion good{Eigen::Isometry3d::Identity(), 1.0, 1.0, 0.5, 2.0};
  EXPECT_EQ(region_error(good), "no error");
  FrustumRegion bad = good;
  bad.near_m = 2.0;
  EXPECT_EQ(region_error(bad), "frustum.near_m: must be at least 0 and less than far_m's 2, is 2");
  bad = good;
  bad.vertical_rad = 0.0;
  EXPECT_EQ(region_error(bad), "frustum.vertical_rad: must be greater than 0 and less than pi, is 0");
  bad = good;
  bad.horizontal_rad = 3.2;
  EXPECT_EQ(region_error(bad), "frustum.horizontal_rad: must be greater than 0 and less than pi, is 3.2");
  bad = good;
  bad.far_m = kInfinity;
  EXPECT_EQ(region_error(bad), "frustum.far_m: must be greater than 0 and at most 1e+06 m, is inf");
  bad = good;
  bad.T_world_sensor.translation().x() = kNan;
  EXPECT_EQ(region_error(bad), "frustum.T_world_sensor: not every number is finite");
  EXPECT_EQ(region_error(CylinderRegion{{1.0, 2.0, 3.0}, {1.0, 2.0, 3.0}, 1.0}),
            "cylinder.to_m: must not be the same point as from_m");
  EXPECT_EQ(region_error(CylinderRegion{{1.0, 2.0, 3.0}, {1.0, 2.0, 4.0}, kNan}),
            "cylinder.radius_m: must be greater than 0 and at most 1e+06 m, is nan");
}

std::string floorplan_with(void (*spoil)(FloorplanQuery&)) {
  FloorplanQuery query;
  spoil(query);
  return message_of(queries().floorplan(query));
}

TEST(QueryErrors, OfFloorplans) {
  EXPECT_EQ(floorplan_with([](auto& q) { q.cut_low_m = -0.1; }), "cut_low_m: must be finite and at least 0, is -0.1");
  EXPECT_EQ(floorplan_with([](auto& q) { q.cut_high_m = 0.9; }),
            "cut_high_m: must be finite and greater than cut_low_m's 0.9, is 0.9");
  EXPECT_EQ(floorplan_with([](auto& q) { q.clear_high_m = kNan; }),
            "clear_high_m: must be finite and greater than clear_low_m's 0.1, is nan");
  EXPECT_EQ(floorplan_with([](auto& q) { q.wall_thickness_m = 0.0; }),
            "wall_thickness_m: must be greater than 0 and at most 1e+06 m, is 0");
  EXPECT_EQ(message_of(testing::map_of({}).queries().floorplan()),
            "floorplan: which way is down is not known (map.gravity)");
  EXPECT_EQ(message_of(SnapshotQueries(testing::map_of({}).snapshot, -Vector3d::UnitZ()).floorplan()),
            "floorplan: no floor was seen that passes the filter");
}

TEST(QueryErrors, OfWhatAnIndexIsMadeFrom) {
  const auto map = testing::map_of({});
  EXPECT_THROW(SnapshotQueries(map.snapshot, Vector3d(Vector3d::Zero())), std::invalid_argument);
  EXPECT_THROW(SnapshotQueries(map.snapshot, Vector3d(0.0, 0.0, kNan)), std::invalid_argument);
  testing::Random random(62);
  EXPECT_THROW(SnapshotQueries(map.snapshot, testing::random_map(random, 3, 0).planes), std::invalid_argument);
}

}  // namespace
}  // namespace planemap

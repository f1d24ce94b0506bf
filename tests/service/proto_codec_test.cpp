#include "codec/proto_codec.hpp"

#include <gtest/gtest.h>
#include <planemap/v1/planes.pb.h>

#include <Eigen/Geometry>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <string>

namespace planemap::service {
namespace {

/// A slanted plane with a hole in its outline and an odd number in every field.
ShapedPlane slanted_plane(PlaneId id) {
  ShapedPlane shaped;
  const Eigen::Vector3d normal = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  shaped.record.id = id;
  shaped.record.centroid_m = {3.25, -1.5, 0.75};
  shaped.record.plane = Plane::through(shaped.record.centroid_m, normal);
  shaped.record.covariance = Eigen::Matrix4d::Identity() * 2e-7;
  shaped.record.covariance(0, 3) = shaped.record.covariance(3, 0) = -3e-8;
  shaped.record.covariance(1, 2) = shaped.record.covariance(2, 1) = 5e-9;
  shaped.record.cell_count = 41;
  shaped.record.point_count = (std::uint64_t{1} << 33) + 7;
  shaped.record.first_seen_utime = 1'700'000'000'000'001;
  shaped.record.last_seen_utime = 1'700'000'060'000'002;
  shaped.record.quality = 0.9375;
  shaped.record.revision = 17;
  shaped.record.merged = {2, 5};
  shaped.plane_class = PlaneClass::kSlope;
  shaped.outline.basis.origin_m = shaped.record.centroid_m;
  shaped.outline.basis.axis_u = normal.unitOrthogonal();
  shaped.outline.basis.axis_v = normal.cross(shaped.outline.basis.axis_u);
  shaped.outline.polygons = {
      {{{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}, {{{0.25, 0.25}, {0.25, 0.5}, {0.5, 0.25}}}},
      {{{2.0, 0.0}, {2.5, 0.0}, {2.5, 0.5}}, {}}};
  shaped.outline.area_m2 = 4.09375;
  return shaped;
}

ShapedMap map_of_two() {
  return {"world", 1'700'000'000'000'000, 21, 1'700'000'060'000'003, 0.08, {slanted_plane(3), slanted_plane(9)}};
}

void expect_equal(const ShapedPlane& got, const ShapedPlane& want) {
  EXPECT_EQ(got.record.id, want.record.id);
  EXPECT_TRUE(got.record.plane.normal().isApprox(want.record.plane.normal(), 1e-15));
  EXPECT_NEAR(got.record.plane.d(), want.record.plane.d(), 1e-14);
  EXPECT_EQ(got.record.covariance, want.record.covariance);
  EXPECT_EQ(got.record.centroid_m, want.record.centroid_m);
  EXPECT_EQ(got.record.cell_count, want.record.cell_count);
  EXPECT_EQ(got.record.point_count, want.record.point_count);
  EXPECT_EQ(got.record.first_seen_utime, want.record.first_seen_utime);
  EXPECT_EQ(got.record.last_seen_utime, want.record.last_seen_utime);
  EXPECT_EQ(got.record.quality, want.record.quality);
  EXPECT_EQ(got.record.revision, want.record.revision);
  EXPECT_EQ(got.record.merged, want.record.merged);
  EXPECT_EQ(got.plane_class, want.plane_class);
  EXPECT_EQ(got.outline.basis.origin_m, want.outline.basis.origin_m);
  EXPECT_EQ(got.outline.basis.axis_u, want.outline.basis.axis_u);
  EXPECT_EQ(got.outline.basis.axis_v, want.outline.basis.axis_v);
  EXPECT_EQ(got.outline.area_m2, want.outline.area_m2);
  ASSERT_EQ(got.outline.polygons.size(), want.outline.polygons.size());
  for (std::size_t i = 0; i < want.outline.polygons.size(); ++i) {
    EXPECT_EQ(got.outline.polygons[i].outer, want.outline.polygons[i].outer);
    EXPECT_EQ(got.outline.polygons[i].holes, want.outline.polygons[i].holes);
  }
}

TEST(ProtoCodec, MapComesBackAsItWentThroughBytes) {
  const ShapedMap map = map_of_two();
  v1::Snapshot message;
  ASSERT_TRUE(message.ParseFromString(to_proto(map).SerializeAsString()));
  const auto back = from_proto(message);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->frame, map.frame);
  EXPECT_EQ(back->epoch, map.epoch);
  EXPECT_EQ(back->revision, map.revision);
  EXPECT_EQ(back->utime, map.utime);
  EXPECT_EQ(back->cell_size_m, map.cell_size_m);
  ASSERT_EQ(back->planes.size(), map.planes.size());
  for (std::size_t i = 0; i < map.planes.size(); ++i) expect_equal(back->planes[i], map.planes[i]);
}

TEST(ProtoCodec, EveryPlaneClassComesBack) {
  for (const PlaneClass c : {PlaneClass::kOther, PlaneClass::kFloor, PlaneClass::kCeiling, PlaneClass::kWall,
                             PlaneClass::kTable, PlaneClass::kSlope}) {
    ShapedPlane plane = slanted_plane(1);
    plane.plane_class = c;
    const v1::Plane message = to_proto(plane);
    // The wire's names are the core's: PLANE_CLASS_FLOOR is "floor".
    std::string name = v1::PlaneClass_Name(message.plane_class()).substr(std::string("PLANE_CLASS_").size());
    for (char& letter : name) letter = static_cast<char>(std::tolower(letter));
    EXPECT_EQ(name, name_of(c));
    const auto back = from_proto(message);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->plane_class, c);
  }
}

struct Damage {
  const char* name;
  const char* expected;  ///< words of the error
  std::function<void(v1::Plane&)> apply;
};

void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.name;
}

class ProtoCodecRejects : public testing::TestWithParam<Damage> {};

TEST_P(ProtoCodecRejects, PlaneWithWords) {
  v1::Plane message = to_proto(slanted_plane(3));
  ASSERT_TRUE(from_proto(message));
  GetParam().apply(message);
  const auto back = from_proto(message);
  ASSERT_FALSE(back);
  EXPECT_NE(back.error().message.find(GetParam().expected), std::string::npos) << back.error().message;
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Fields, ProtoCodecRejects,
    testing::Values(Damage{"IdZero", "id is 0", [](v1::Plane& p) { p.set_id(0); }},
                    Damage{"IdTooLarge", "2^53", [](v1::Plane& p) { p.set_id(std::uint64_t{1} << 53); }},
                    Damage{"NormalMissing", "normal", [](v1::Plane& p) { p.clear_normal(); }},
                    Damage{"NormalTooLong", "normal", [](v1::Plane& p) { p.mutable_normal()->set_x(1.0); }},
                    Damage{"OffsetNan", "finite", [](v1::Plane& p) { p.set_d_m(kNan); }},
                    Damage{"CovarianceShort", "9 numbers", [](v1::Plane& p) { p.mutable_covariance()->RemoveLast(); }},
                    Damage{"CovarianceNegative", "negative variance", [](v1::Plane& p) { p.set_covariance(9, -1e-9); }},
                    Damage{"CentroidNan", "centroid_m", [](v1::Plane& p) { p.mutable_centroid_m()->set_y(kNan); }},
                    Damage{"QualityAboveOne", "quality", [](v1::Plane& p) { p.set_quality(1.01); }},
                    Damage{"ClassUnknown", "plane_class",
                           [](v1::Plane& p) { p.set_plane_class(static_cast<v1::PlaneClass>(77)); }},
                    Damage{"AxesSwapped", "axis_u x axis_v",
                           [](v1::Plane& p) {
                             p.mutable_outline()->mutable_axis_u()->Swap(p.mutable_outline()->mutable_axis_v());
                           }},
                    Damage{"RingOdd", "5 numbers",
                           [](v1::Plane& p) {
                             p.mutable_outline()->mutable_polygons(1)->mutable_outer()->mutable_uv_m()->RemoveLast();
                           }},
                    Damage{"RingInfinite", "not finite",
                           [](v1::Plane& p) {
                             p.mutable_outline()->mutable_polygons(0)->mutable_holes(0)->set_uv_m(2, HUGE_VALF);
                           }},
                    Damage{"AreaNegative", "area_m2", [](v1::Plane& p) { p.mutable_outline()->set_area_m2(-1.0); }}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ProtoCodec, RejectsMapsWhosePlanesAreNotInOrder) {
  v1::Snapshot message = to_proto(map_of_two());
  message.mutable_planes()->SwapElements(0, 1);
  EXPECT_FALSE(from_proto(message));
  message.mutable_planes(0)->set_id(message.planes(1).id());
  EXPECT_FALSE(from_proto(message));
}

TEST(ProtoCodec, RejectsMapsWithoutCellSize) {
  v1::Snapshot message = to_proto(map_of_two());
  message.clear_cell_size_m();
  EXPECT_FALSE(from_proto(message));
}

}  // namespace
}  // namespace planemap::service

#include "codec/plane_cloud.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <planemap/mapper.hpp>
#include <set>

#include "codec/scan_codec.hpp"
#include "serve/lcm/plane_cloud_maker.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

/// A square of 2 m with a hole of 1 m at its middle, in the plane z = 3, and its id.
DescribedPlane square(PlaneId id, double edge_m = 2.0, double hole_m = 1.0) {
  PlaneRecord record;
  record.plane = Plane::through({0.0, 0.0, 3.0}, Eigen::Vector3d::UnitZ());
  record.id = id;
  Outline outline;
  outline.basis = {{0.0, 0.0, 3.0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
  const double e = edge_m / 2.0;
  const double h = hole_m / 2.0;
  outline.polygons.push_back({{{-e, -e}, {e, -e}, {e, e}, {-e, e}}, {{{-h, -h}, {-h, h}, {h, h}, {h, -h}}}});
  return {std::make_shared<const PlaneRecord>(std::move(record)), std::make_shared<const Outline>(std::move(outline)),
          PlaneClass::kOther};
}

struct CloudPoint {
  float xyz[3];
  std::uint32_t rgb;
};
std::vector<CloudPoint> points_of(const drake::lcmt_point_cloud& cloud) {
  std::vector<CloudPoint> points(static_cast<std::size_t>(cloud.width));
  EXPECT_EQ(cloud.data.size(), 16 * points.size());
  std::memcpy(points.data(), cloud.data.data(), cloud.data.size());
  return points;
}

TEST(PlaneCloud, IsWhatDrakesViewersRead) {
  const DescribedPlane planes[] = {square(1)};
  const auto cloud = to_point_cloud(planes, 77, "world", 100000);
  EXPECT_EQ(cloud.utime, 77);
  EXPECT_EQ(cloud.frame_name, "world");
  EXPECT_EQ(cloud.height, 1);
  EXPECT_EQ(cloud.flags, 2);  // strictly finite, little-endian
  EXPECT_EQ(cloud.point_step, 16);
  EXPECT_EQ(cloud.row_step, 16 * cloud.width);
  EXPECT_EQ(cloud.data_size, 16 * cloud.width);
  ASSERT_EQ(cloud.num_fields, 4);
  const struct {
    const char* name;
    int datatype;
  } fields[] = {{"x", 7}, {"y", 7}, {"z", 7}, {"rgb", 6}};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(cloud.fields[static_cast<std::size_t>(i)].name, fields[i].name);
    EXPECT_EQ(cloud.fields[static_cast<std::size_t>(i)].byte_offset, 4 * i);
    EXPECT_EQ(cloud.fields[static_cast<std::size_t>(i)].datatype, fields[i].datatype);
    EXPECT_EQ(cloud.fields[static_cast<std::size_t>(i)].count, 1);
  }
}

TEST(PlaneCloud, FillsTheBoundaryAndLeavesItsHolesOut) {
  const DescribedPlane planes[] = {square(1)};
  const auto points = points_of(to_point_cloud(planes, 77, "world", 100000));
  EXPECT_EQ(points.size(), 40u * 40u - 20u * 20u);
  std::set<std::pair<int, int>> seen;
  for (const CloudPoint& p : points) {
    EXPECT_EQ(p.xyz[2], 3.0F);
    EXPECT_LT(std::max(std::abs(p.xyz[0]), std::abs(p.xyz[1])), 1.0F);
    EXPECT_GT(std::max(std::abs(p.xyz[0]), std::abs(p.xyz[1])), 0.5F);
    seen.emplace(std::lround(p.xyz[0] * 1000), std::lround(p.xyz[1] * 1000));
  }
  EXPECT_EQ(seen.size(), points.size());
}

TEST(PlaneCloud, HasNoMorePointsThanItMayAndPlanesDifferInColour) {
  std::vector<DescribedPlane> planes;
  for (PlaneId id = 1; id <= 300; ++id) planes.push_back(square(id, 2.0, 0.2));
  const auto points = points_of(to_point_cloud(planes, 77, "world", 5000));
  EXPECT_LE(points.size(), 5000u);
  EXPECT_GT(points.size(), 2500u);
  std::set<std::uint32_t> colours;
  for (const CloudPoint& p : points) colours.insert(p.rgb);
  EXPECT_GT(colours.size(), 250u);
  // More planes than points: the grid becomes too wide for them, and it comes to an end.
  EXPECT_LE(to_point_cloud(planes, 77, "world", 100).width, 100);
  EXPECT_EQ(to_point_cloud({}, 77, "world", 100).width, 0);
}

TEST(PlaneCloud, OfAMapIsMadeOncePerRevisionAndReadsBack) {
  Mapper mapper(preset(Preset::kBest), 9);
  DepthScan scan;
  scan.utime = 1000000;
  scan.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
  scan.depth.assign(80 * 60, 1500);
  mapper.integrate(scan, Eigen::Isometry3d::Identity());
  const auto snapshot = mapper.snapshot();
  PlaneBook book{MapConfig{}};
  PlaneCloudMaker maker(ServiceConfig{}, book);
  const Page message = maker.make(snapshot);
  EXPECT_EQ(maker.make(snapshot).data(), maker.make(snapshot).data());
  const auto decoded = decode_scan(message, 1 << 20);  // the type comes in as well
  ASSERT_TRUE(decoded) << decoded.error().message;
  const auto& xyz = std::get<PointScan>(decoded->scan).xyz_m;
  ASSERT_GT(xyz.size(), 300u);
  for (std::size_t i = 2; i < xyz.size(); i += 3) EXPECT_NEAR(xyz[i], 1.5, 1e-3);
  const double area_m2 = static_cast<double>(xyz.size() / 3) * kCloudSpacingM * kCloudSpacingM;
  double outlines_m2 = 0.0;
  for (const auto& plane : book.open(snapshot)->planes()) outlines_m2 += plane.outline->area_m2;
  EXPECT_NEAR(area_m2, outlines_m2, 0.15);
}

}  // namespace
}  // namespace planemap::service

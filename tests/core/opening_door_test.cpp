// A door that lies in its wall, one plane with it, and then opens: the plane gives up what is no longer there, and the
// leaf becomes a plane of its own.

#include <gtest/gtest.h>

#include <cmath>
#include <planemap/mapper.hpp>
#include <vector>

#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kWall_m = 2.0;  // x of the wall
constexpr double kHinge_m = -0.4;
constexpr double kLeaf_m = 0.8;
constexpr int kClosedScans = 20;
constexpr int kOpenScans = 50;

double leaf_angle_rad = 0.0;  // a wall's shape is a plain function

bool in_door(double y_m, double z_m) {
  return y_m > kHinge_m && y_m < kHinge_m + kLeaf_m && z_m < 0.8;
}
bool beside_door(const Vector3d& p) {
  return !in_door(p.y(), p.z());
}
bool on_leaf(const Vector3d& p) {
  const double along_m = std::hypot(p.x() - kWall_m, p.y() - kHinge_m);
  return p.x() >= kWall_m && in_door(kHinge_m + along_m, p.z());
}
Vector3d leaf_normal() {
  return Eigen::AngleAxisd(-leaf_angle_rad, Vector3d::UnitZ()) * -Vector3d::UnitX();
}
std::vector<testing::Wall> walls(bool open) {
  if (!open) return {{-Vector3d::UnitX(), kWall_m}};
  return {{-Vector3d::UnitX(), kWall_m, beside_door},
          {leaf_normal(), -leaf_normal().dot(Vector3d(kWall_m, kHinge_m, 0.0)), on_leaf},
          {-Vector3d::UnitX(), 4.0}};
}
/// From before the middle of the door, turning a little.
Isometry3d pose(int i) {
  return testing::looking({0.0, 0.02 * std::sin(0.3 * i), 0.2}, {2.0, 0.2 * std::sin(0.2 * i), 0.1});
}
void look(Mapper& mapper, int i, bool open) {
  DepthScan scan = testing::render(walls(open), pose(i), static_cast<std::uint64_t>(i));
  scan.utime = 1'000'000 + 100'000 * i;
  mapper.integrate(scan, pose(i));
}
const PlaneRecord* plane_like(const MapSnapshot& map, const Vector3d& normal, const Vector3d& p_m) {
  for (const auto& record : map.planes()) {
    if (testing::degrees_between(record->plane.normal(), normal) < 2.0 &&
        std::abs(record->plane.signed_distance_m(p_m)) < 0.02) {
      return record.get();
    }
  }
  return nullptr;
}

class OpeningDoor : public ::testing::TestWithParam<double> {};

TEST_P(OpeningDoor, SplitsFromItsWall) {
  leaf_angle_rad = GetParam() * M_PI / 180.0;
  const Vector3d hinge_m(kWall_m, kHinge_m, 0.0);
  Mapper mapper(preset(Preset::kBest), 1);
  for (int i = 0; i < kClosedScans; ++i) look(mapper, i, false);
  const auto closed = mapper.snapshot();
  const PlaneRecord* wall = plane_like(*closed, -Vector3d::UnitX(), hinge_m);
  ASSERT_NE(wall, nullptr);
  EXPECT_EQ(closed->planes().size(), 1U);

  for (int i = kClosedScans; i < kClosedScans + kOpenScans; ++i) look(mapper, i, true);
  const auto open = mapper.snapshot();
  const PlaneRecord* leaf = plane_like(*open, leaf_normal(), hinge_m);
  ASSERT_NE(leaf, nullptr);
  EXPECT_NE(leaf->id, wall->id);
  EXPECT_LT(testing::degrees_between(leaf->plane.normal(), leaf_normal()), 0.3);

  const PlaneRecord* kept = open->find(wall->id);
  ASSERT_NE(kept, nullptr);  // the wall is who it was
  EXPECT_LT(testing::degrees_between(kept->plane.normal(), -Vector3d::UnitX()), 0.1);
  EXPECT_LT(std::abs(kept->plane.signed_distance_m(hinge_m)), 0.001);
  // Nothing of it where the leaf was, but for the rim, and what is less than 20 cm before the leaf: wear needs room to
  // be sure. The image ends at the lower end of the door.
  std::size_t stale = 0;
  open->for_each_cell([&](const CellView& cell) {
    const Vector3d& p = cell.centre_m;
    const double before_leaf_m = (p.y() - kHinge_m) * std::sin(leaf_angle_rad);
    if (cell.plane_id != wall->id || !in_door(p.y() + 0.08, p.z() + 0.08) || p.z() < -0.6) return;
    if (before_leaf_m > 0.2) ++stale;
  });
  EXPECT_EQ(stale, 0U);
}

INSTANTIATE_TEST_SUITE_P(ByDegrees, OpeningDoor, ::testing::Values(10.0, 25.0, 60.0));

}  // namespace
}  // namespace planemap

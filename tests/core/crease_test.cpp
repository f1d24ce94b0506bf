// A door's reveal beside its open leaf: two strips that hardly differ are two planes, and each cell is its own plane's.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <planemap/mapper.hpp>
#include <vector>

#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;

/// The leaf of an open door, and beside it, 3 cm on, the 12 cm wide reveal, which turns away by 6 degrees. All of it is
/// turned against the grid.
class OpenDoor {
 public:
  static constexpr int kFarLooks = 6;
  static constexpr int kLooks = 12;
  static constexpr double kGap_m = 0.03;
  static constexpr double kStep_m = 0.003;
  static constexpr double kReveal_m = 0.12;

  static Vector3d to_house(const Vector3d& p) { return turned().transpose() * p; }
  static Vector3d reveal_normal() { return turned() * house_normal(); }
  static std::vector<testing::Wall> walls() {
    const Vector3d begin_m(kGap_m, kStep_m, 0.0);
    return {{turned() * Vector3d(0, -1, 0), 0.0, [](const Vector3d& p) { return to_house(p).x() < 0.0; }},
            {reveal_normal(), -house_normal().dot(begin_m), [](const Vector3d& p) { return is_in_reveal(p); }},
            {turned() * Vector3d(0, -1, 0), 1.0, nullptr}};
  }
  static bool is_in_reveal(const Vector3d& p) {
    const double x_m = to_house(p).x();
    return x_m > kGap_m && x_m < kGap_m + kReveal_m;
  }
  /// Looks from afar, which see the strips as one, and then from near at a part of them.
  static Eigen::Isometry3d pose(int i) {
    const double distance_m = i < kFarLooks ? 2.0 : 1.2;
    return testing::looking(turned() * Vector3d(-0.2 - 0.01 * i, -distance_m, 0.05 * (i % 5)),
                            turned() * Vector3d(-0.1, 0.0, 0.01 * i));
  }

 private:
  static const Eigen::Matrix3d& turned() {
    static const Eigen::Matrix3d kR = Eigen::AngleAxisd(0.6, Vector3d::UnitZ()).toRotationMatrix();
    return kR;
  }
  static const Vector3d& house_normal() {
    static const Vector3d kNormal = Eigen::AngleAxisd(6.0 * M_PI / 180.0, Vector3d::UnitZ()) * Vector3d(0, -1, 0);
    return kNormal;
  }
};

TEST(Creases, TheRevealBesideADoorsLeafGetsAllItsCells) {
  Mapper mapper(MapperConfig{}, 1);
  for (int i = 0; i < OpenDoor::kLooks; ++i) {
    mapper.integrate(testing::render(OpenDoor::walls(), OpenDoor::pose(i), static_cast<std::uint64_t>(i)),
                     OpenDoor::pose(i));
  }
  const auto map = mapper.snapshot();
  std::map<PlaneId, std::size_t> cells;  // of the reveal, by plane
  std::size_t all = 0;
  map->for_each_cell([&](const CellView& cell) {
    const Vector3d p_m = OpenDoor::to_house(cell.centre_m);
    const bool inside = p_m.x() > 0.05 && p_m.x() < 0.13 && std::abs(p_m.y()) < 0.05;
    if (!inside) return;
    ++cells[cell.plane_id];
    ++all;
  });
  ASSERT_GT(all, 20U);
  PlaneId reveal = kNoPlane;
  for (const auto& record : map->planes()) {
    const bool alike = testing::degrees_between(record->plane.normal(), OpenDoor::reveal_normal()) < 1.5;
    if (alike && cells[record->id] > cells[reveal]) reveal = record->id;
  }
  ASSERT_NE(reveal, kNoPlane);
  EXPECT_GE(static_cast<double>(cells[reveal]), 0.9 * static_cast<double>(all));
}

}  // namespace
}  // namespace planemap

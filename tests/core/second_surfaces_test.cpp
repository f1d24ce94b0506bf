// Places that two cells share: each point goes to the cell whose plane it is on.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <planemap/mapper.hpp>
#include <random>
#include <set>
#include <vector>

#include "divider.hpp"
#include "rooms.hpp"
#include "simd/select_kernels.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;

constexpr double kCell_m = 0.1;

/// Two metres above the origin, looking down: the sensor's z is the world's -z.
ScanFrame from_above() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  T.translation() = Vector3d(0.05, 0.05, 2.05);
  return {CellIndex(0, 0, 20), T, kCell_m, 0.0};
}

/// Squared distance of a point over what is allowed: 1 on the border.
double ratio(const simd::ScanPlane& plane, const Vector3d& p_world_m, double variance_z_m2) {
  const Vector3d place = p_world_m / kCell_m - Vector3d(0.0, 0.0, 20.0);
  double distance = static_cast<double>(plane.d_cells);
  for (int k = 0; k < 3; ++k) distance += static_cast<double>(plane.normal[k]) * place(k);
  const double allowed =
      static_cast<double>(plane.allowed_cells2) + static_cast<double>(plane.variance_factor[2]) * variance_z_m2;
  return distance * distance / allowed;
}

TEST(ScanPlane, APointIsOnItUpToFourAndAHalfSigmaAndACentimetreAndAHalf) {
  const Plane floor = Plane::through({0.0, 0.0, 0.25}, Vector3d::UnitZ());
  const simd::ScanPlane plane = scan_plane(&floor, from_above());
  EXPECT_NEAR(ratio(plane, {0.3, -0.2, 0.265}, 0.0), 1.0, 1e-4);
  EXPECT_NEAR(ratio(plane, {0.3, -0.2, 0.235}, 0.0), 1.0, 1e-4);
  // 20 mm of noise: sqrt(90^2 + 15^2) mm.
  EXPECT_NEAR(ratio(plane, {0.3, -0.2, 0.25 + std::sqrt(0.008325)}, 4e-4), 1.0, 1e-4);
  ScanFrame wandering = from_above();
  wandering.pose_variance_m2 = 4e-4;
  EXPECT_NEAR(ratio(scan_plane(&floor, wandering), {0.0, 0.0, 0.25 + std::sqrt(0.008325)}, 0.0), 1.0, 1e-4);
}

TEST(ScanPlane, NothingIsOnOneThatTurnsItsBackToTheSensor) {
  const Plane ceiling = Plane::through({0.0, 0.0, 0.25}, -Vector3d::UnitZ());
  EXPECT_TRUE(std::isinf(ratio(scan_plane(&ceiling, from_above()), {0.0, 0.0, 0.25}, 0.0)));
}

TEST(ScanPlane, WhereNoneIsKnownEveryPointIsJustAllowed) {
  EXPECT_EQ(ratio(scan_plane(nullptr, from_above()), {0.0, 0.0, 0.25}, 4e-4), 1.0);
  EXPECT_EQ(ratio(scan_plane(nullptr, from_above()), {1.0, 2.0, 3.0}, 4e-4), 1.0);
}

/// What the kernel does, in doubles and for one point at a time.
std::int32_t twin(const simd::PointChunk& chunk, std::size_t at, const simd::Divider& divider) {
  const std::int32_t target = chunk.target[at];
  if (target != divider.target[0] && target != divider.target[1]) return target;
  double ratios[2];
  for (int i = 0; i < 2; ++i) {
    const simd::ScanPlane& plane = divider.plane[i];
    double distance = static_cast<double>(plane.d_cells);
    double allowed = static_cast<double>(plane.allowed_cells2);
    for (int k = 0; k < 3; ++k) {
      distance += static_cast<double>(plane.normal[k]) * static_cast<double>(chunk.place_cells[k][at]);
      allowed += static_cast<double>(plane.variance_factor[k]) * static_cast<double>(chunk.variance_m2[k][at]);
    }
    ratios[i] = distance * distance / allowed;
  }
  return divider.target[ratios[1] < ratios[0] ? 1 : 0];
}

TEST(Divide, AgreesWithItsSlowTwinOnEveryInstructionSet) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> place(-3.0F, 3.0F);
  std::uniform_int_distribution<std::int32_t> target(0, 5);
  const Plane level = Plane::through({0.0, 0.0, 2.0}, Vector3d::UnitZ());
  const Plane leaning = Plane::through({0.0, 0.1, 2.0}, Vector3d(0.6, 0.0, 0.8));
  const Plane averted = Plane::through({0.0, 0.0, 2.0}, -Vector3d::UnitZ());
  const auto scan = [](const Plane* plane) { return scan_plane(plane, from_above()); };
  const std::vector<simd::Divider> dividers = {{{0, 1}, {scan(&level), scan(&leaning)}},
                                               {{2, 3}, {scan(&averted), scan(nullptr)}},
                                               {{4, 5}, {scan(&leaning), scan(nullptr)}}};
  for (const SimdTarget set : {SimdTarget::kAuto, SimdTarget::kAvx2, SimdTarget::kAvx512, SimdTarget::kSse4,
                               SimdTarget::kNeon, SimdTarget::kScalar}) {
    if (!is_supported(set)) continue;
    simd::PointChunk chunk;
    chunk.size = 203;
    simd::PointChunk expected = chunk;
    for (std::size_t at = simd::PointChunk::kPad; at < simd::PointChunk::kPad + chunk.size; ++at) {
      for (int k = 0; k < 3; ++k) {
        chunk.place_cells[k][at] = place(random);
        chunk.variance_m2[k][at] = 1e-4F * std::abs(place(random));
      }
      chunk.target[at] = target(random);
      expected.target[at] = chunk.target[at];
    }
    std::set<std::int32_t> seen;
    for (std::size_t at = simd::PointChunk::kPad; at < simd::PointChunk::kPad + chunk.size; ++at) {
      for (const simd::Divider& divider : dividers) {
        const std::int32_t before = chunk.target[at];
        const std::int32_t owner = twin(chunk, at, divider);
        if (before == divider.target[0] || before == divider.target[1]) expected.target[at] = owner;
      }
      seen.insert(expected.target[at]);
    }
    EXPECT_EQ(seen, (std::set<std::int32_t>{0, 1, 3, 4, 5}));  // nothing is on the averted one
    std::vector<simd::Accumulator> accumulators(6);
    for (std::size_t i = 0; i < accumulators.size(); ++i) accumulators[i].divider = static_cast<std::int32_t>(i / 2);
    simd::kernels(set).divide(chunk, accumulators.data(), dividers.data());
    for (std::size_t at = simd::PointChunk::kPad; at < simd::PointChunk::kPad + chunk.size; ++at) {
      EXPECT_EQ(chunk.target[at], expected.target[at]) << at;
    }
  }
}

/// A doorway in a wall that is turned against the grid: its reveal is 12 cm deep, one and a half cells.
class Doorway {
 public:
  static constexpr double kDepth_m = 0.12;

  static const Eigen::Matrix3d& turned() {
    static const Eigen::Matrix3d kR = Eigen::AngleAxisd(0.6, Vector3d::UnitZ()).toRotationMatrix();
    return kR;
  }
  /// Its surfaces in house coordinates: wall y = 0 with x < 0, reveal x = 0, and a wall far behind.
  static std::vector<testing::Wall> walls() {
    const auto house = [](const Vector3d& p) { return Vector3d(turned().transpose() * p); };
    static const auto kHouse = house;
    const auto wall = [](const Vector3d& normal, double d, bool (*keep)(const Vector3d&)) {
      return testing::Wall{turned() * normal, d, keep};
    };
    return {wall({0, -1, 0}, 0.0, [](const Vector3d& p) { return kHouse(p).x() < 0.0; }),
            wall({1, 0, 0}, 0.0, [](const Vector3d& p) { return kHouse(p).y() > 0.0 && kHouse(p).y() < kDepth_m; }),
            wall({0, -1, 0}, 1.5, nullptr)};
  }
  static Eigen::Isometry3d pose(int i) {
    const double x = 0.7 + 0.01 * i;
    return testing::looking(turned() * Vector3d(x, -1.2, 0.05 * (i % 5)), turned() * Vector3d(0.0, 0.05, 0.02 * i));
  }
  /// The plane that faces as the reveal does; nullptr: there is none.
  static const PlaneRecord* reveal(const MapSnapshot& map) {
    for (const auto& record : map.planes()) {
      if (testing::degrees_between(record->plane.normal(), turned() * Vector3d::UnitX()) < 10.0) return record.get();
    }
    return nullptr;
  }
};

TEST(SecondSurfaces, TheRevealOfADoorIsAPlaneAsRightAsAWall) {
  Mapper mapper(MapperConfig{}, 1);
  for (int i = 0; i < 40; ++i) {
    mapper.integrate(testing::render(Doorway::walls(), Doorway::pose(i), static_cast<std::uint64_t>(i)),
                     Doorway::pose(i));
  }
  const auto map = mapper.snapshot();
  const PlaneRecord* reveal = Doorway::reveal(*map);
  ASSERT_NE(reveal, nullptr);
  EXPECT_LT(testing::degrees_between(reveal->plane.normal(), Doorway::turned() * Vector3d::UnitX()), 0.2);
  EXPECT_NEAR(reveal->plane.signed_distance_m(Doorway::turned() * Vector3d(0.0, 0.06, 0.4)), 0.0, 0.0005);
  // Along the edge a place has two cells, and each is on its own plane.
  std::map<std::array<int, 3>, std::set<PlaneId>> planes;
  map->for_each_cell([&](const CellView& cell) {
    if (cell.plane_id != kNoPlane) planes[{cell.index.x(), cell.index.y(), cell.index.z()}].insert(cell.plane_id);
  });
  const auto shared = std::count_if(planes.begin(), planes.end(), [&](const auto& place) {
    return place.second.size() == 2 && place.second.count(reveal->id) == 1;
  });
  EXPECT_GT(shared, 10);
}

}  // namespace
}  // namespace planemap

#include "planemap/coplanar.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <planemap/mapper.hpp>
#include <random>

#include "plane_records.hpp"
#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;
using testing::record_of;

constexpr double kSure = 1e-5;  // metres and radians

/// Two pieces of a level surface, 3 m apart, the second raised by step_m and tilted about x and y.
bool level_pieces_agree(double step_m, double about_x_rad, double about_y_rad, double offset_m = kSure,
                        double tilt_rad = kSure) {
  const Vector3d turned(std::sin(about_y_rad), -std::sin(about_x_rad), 1.0);
  return are_coplanar(record_of(1, {10.0, 4.0, 0.7}, Vector3d::UnitZ(), offset_m, tilt_rad),
                      record_of(2, {13.0, 4.0, 0.7 + step_m}, turned, offset_m, tilt_rad));
}

TEST(Coplanar, SurePlanesAgreeUpToACentimetre) {
  // Two ends, each off by step: 2 (step / 5 mm)^2 = 7.815 at 9.88 mm.
  EXPECT_TRUE(level_pieces_agree(0.0098, 0.0, 0.0));
  EXPECT_FALSE(level_pieces_agree(0.0100, 0.0, 0.0));
  EXPECT_TRUE(level_pieces_agree(-0.0098, 0.0, 0.0));
  EXPECT_FALSE(level_pieces_agree(-0.0100, 0.0, 0.0));
}

TEST(Coplanar, ATurnAboutTheLineBetweenThemIsAllowedUpToOnePointFourDegrees) {
  // 0.5 degrees sqrt(7.815) = 1.398 degrees about x, on which the centroids lie.
  EXPECT_TRUE(level_pieces_agree(0.0, 1.38 * M_PI / 180.0, 0.0));
  EXPECT_FALSE(level_pieces_agree(0.0, 1.42 * M_PI / 180.0, 0.0));
}

TEST(Coplanar, ATiltAlongTheLineCountsByWhatItDoesAtTheOtherEnd) {
  // At the other's centroid 3 m away the second is off by 3 tan(tilt): alone 5 mm sqrt(7.815) = 13.98 mm.
  EXPECT_TRUE(level_pieces_agree(0.0, 0.0, std::atan(0.0138 / 3.0)));
  EXPECT_FALSE(level_pieces_agree(0.0, 0.0, std::atan(0.0142 / 3.0)));
}

TEST(Coplanar, WhatIsNotKnownBetterIsAllowedMore) {
  // Either known to 10 mm: both ends err together, (5^2 + 2 * (2 * 10^2)) / 2 = 212.5 square millimetres for their
  // mean; step^2 / 212.5 = 7.815 at 40.7 mm.
  EXPECT_TRUE(level_pieces_agree(0.040, 0.0, 0.0, 0.010));
  EXPECT_FALSE(level_pieces_agree(0.0415, 0.0, 0.0, 0.010));
}

TEST(Coplanar, WhereNobodyCanTellThereIsNoLink) {
  EXPECT_TRUE(level_pieces_agree(0.0, 0.0, 0.0, 0.0140));  // 14 mm each: 19.8 mm of both
  EXPECT_FALSE(level_pieces_agree(0.0, 0.0, 0.0, 0.0143));
  EXPECT_TRUE(level_pieces_agree(0.0, 0.0, 0.0, kSure, 0.0046));   // at 3 m: sqrt((3 * 4.6 mm)^2 + ...) = 13.8 mm
  EXPECT_FALSE(level_pieces_agree(0.0, 0.0, 0.0, kSure, 0.0068));  // 20.4 mm
}

TEST(Coplanar, TheTwoFacesOfASheetAreNotCoplanar) {
  EXPECT_FALSE(are_coplanar(record_of(1, {0.0, 0.0, 0.0}, Vector3d::UnitZ(), kSure, kSure),
                            record_of(2, {2.0, 0.0, 0.0}, -Vector3d::UnitZ(), kSure, kSure)));
}

TEST(Coplanar, PiecesAboutOneCentreAreComparedOverAMetre) {
  // A picture frame and the picture: at half a metre to either side a tilt of 1.5 degrees shows as 13 mm.
  const auto frame = record_of(1, {5.0, 0.0, 1.0}, Vector3d::UnitX(), kSure, kSure);
  EXPECT_TRUE(are_coplanar(frame, record_of(2, {5.0, 0.0, 1.0}, {1.0, 0.01, 0.0}, kSure, kSure)));
  EXPECT_FALSE(are_coplanar(frame, record_of(2, {5.0, 0.0, 1.0}, {1.0, 0.05, 0.05}, kSure, kSure)));
}

TEST(Coplanar, SmallPlanesAreLinkedWithNone) {
  const auto a = record_of(3, {0.0, 0.0, 0.7}, Vector3d::UnitZ(), kSure, kSure);
  const auto b = record_of(8, {4.0, 0.0, 0.7}, Vector3d::UnitZ(), kSure, kSure);
  const std::vector<SizedPlane> large = {{&a, 0.25}, {&b, 0.3}};
  EXPECT_EQ(coplanar_links(large), (CoplanarLinks{{3, {8}}, {8, {3}}}));
  const std::vector<SizedPlane> one_small = {{&a, 0.24}, {&b, 0.3}};
  EXPECT_TRUE(coplanar_links(one_small).empty());
  EXPECT_TRUE(coplanar_links(std::vector<SizedPlane>{}).empty());
}

TEST(Coplanar, TheSearchFindsWhatComparingAllPairsFinds) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> anywhere(-15.0, 15.0);
  std::normal_distribution<double> normal;
  std::size_t links_found = 0;
  for (int round = 0; round < 20; ++round) {
    // Few base planes in any direction, and near each of them pieces that are off by about what is allowed.
    std::vector<PlaneRecord> records;
    for (int base = 0; base < 12; ++base) {
      const Vector3d n = Vector3d(normal(random), normal(random), normal(random)).normalized();
      const double d = 0.3 * anywhere(random);
      for (int k = 0; k < 12; ++k) {
        const Vector3d place(anywhere(random), anywhere(random), anywhere(random));
        const Vector3d on_plane = place - (n.dot(place) + d - 0.01 * normal(random)) * n;
        const Vector3d turned = n + 0.01 * Vector3d(normal(random), normal(random), normal(random));
        const double unsure = k % 2 == 0 ? 0.001 : 0.008;
        records.push_back(
            record_of(1 + records.size(), on_plane, k % 5 == 4 ? Vector3d(-turned) : turned, unsure, 0.2 * unsure));
      }
    }
    std::vector<SizedPlane> planes;
    for (const auto& record : records) planes.push_back({&record, 1.0});
    CoplanarLinks all_pairs;
    for (const auto& a : records) {
      for (const auto& b : records) {
        if (a.id != b.id && are_coplanar(a, b)) all_pairs[a.id].push_back(b.id);
      }
    }
    ASSERT_EQ(coplanar_links(planes), all_pairs) << round;
    for (const auto& entry : all_pairs) links_found += entry.second.size();
  }
  EXPECT_GT(links_found, 500u);
}

TEST(Coplanar, TheSearchReachesAsFarAsTheComparison) {
  // Pairs at the edge of what are_coplanar() allows: as unsure as may be, and off by as much as that lets them be; and
  // at the edge of a large map, where a turn shows most.
  std::mt19937_64 random(19);
  std::normal_distribution<double> normal;
  const auto some_vector = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
  const auto far = record_of(3, Vector3d::Zero(), {1.0, 2.0, 3.0}, kSure, kSure);
  int linked = 0;
  for (int round = 0; round < 20000; ++round) {
    const Vector3d n = some_vector().normalized();
    const Vector3d centre_m = 30.0 * some_vector().normalized();
    const auto a = record_of(1, centre_m, n, 0.010, 0.012);
    const Vector3d beside_m = centre_m + 0.6 * n.unitOrthogonal() + 0.02 * normal(random) * n;
    const auto b = record_of(2, beside_m, n + 0.05 * some_vector(), 0.010, 0.012);
    if (!are_coplanar(a, b)) continue;
    ++linked;
    std::vector<SizedPlane> planes(10, SizedPlane{&far, 1.0});
    planes.push_back({&a, 1.0});
    planes.push_back({&b, 1.0});
    const CoplanarLinks links = coplanar_links(planes);
    ASSERT_EQ(links.count(1), 1u) << a.plane.normal().dot(b.plane.normal());
  }
  EXPECT_GT(linked, 500);
}

bool left_piece(const Vector3d& p) {
  return p.y() < -0.75;
}
bool right_piece(const Vector3d& p) {
  return p.y() > 0.75;
}
bool left_table(const Vector3d& p) {
  return std::abs(p.y() + 2.0) < 0.4 && std::abs(p.x() - 2.0) < 0.6;
}
bool right_table(const Vector3d& p) {
  return std::abs(p.y() - 2.0) < 0.4 && std::abs(p.x() - 2.0) < 0.6;
}

/// Looks to the left and to the right from y = -2 and y = 2. @return large planes and the links between them
struct Seen {
  std::size_t planes = 0;
  CoplanarLinks links;
};
Seen looks_left_and_right(const std::vector<testing::Wall>& walls, double look_at_z_m) {
  Mapper mapper(preset(Preset::kBest), 1);
  for (int i = 0; i < 8; ++i) {
    const double y = i % 2 == 0 ? -2.0 : 2.0;
    const auto T = testing::looking({0.0, y, 1.5}, {2.0, y, look_at_z_m});
    mapper.integrate(testing::render(walls, T, static_cast<std::uint64_t>(i)), T);
  }
  const auto map = mapper.snapshot();
  const auto planes = map->planes();
  const auto large = std::count_if(planes.begin(), planes.end(), [](const auto& r) { return r->cell_count > 40; });
  return {static_cast<std::size_t>(large), coplanar_links(*map)};
}

TEST(Coplanar, PiecesOfAWallOneAndAHalfMetresApartAreLinkedNotMerged) {
  const Seen seen =
      looks_left_and_right({{-Vector3d::UnitX(), 2.5, left_piece}, {-Vector3d::UnitX(), 2.5, right_piece}}, 1.5);
  EXPECT_EQ(seen.planes, 2u);
  EXPECT_EQ(seen.links.size(), 2u);
}

TEST(Coplanar, ParallelWallsThreeCentimetresApartAreNotLinked) {
  const Seen seen =
      looks_left_and_right({{-Vector3d::UnitX(), 2.5, left_piece}, {-Vector3d::UnitX(), 2.53, right_piece}}, 1.5);
  EXPECT_EQ(seen.planes, 2u);
  EXPECT_TRUE(seen.links.empty());
}

TEST(Coplanar, TablesOfOneHeightInTwoRoomsAreLinked) {
  const Seen same =
      looks_left_and_right({{Vector3d::UnitZ(), -0.7, left_table}, {Vector3d::UnitZ(), -0.7, right_table}}, 0.7);
  EXPECT_EQ(same.planes, 2u);
  EXPECT_EQ(same.links.size(), 2u);
  const Seen other =
      looks_left_and_right({{Vector3d::UnitZ(), -0.7, left_table}, {Vector3d::UnitZ(), -0.74, right_table}}, 0.7);
  EXPECT_EQ(other.planes, 2u);
  EXPECT_TRUE(other.links.empty());
}

}  // namespace
}  // namespace planemap

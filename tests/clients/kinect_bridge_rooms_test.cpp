// The special rooms: their truth is what was promised, what is rendered agrees with it, and their tours show it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <planemap/simulation/scenes.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/simulation/truth_file.hpp>
#include <string>
#include <vector>

#include "kinect_bridge_test_scene.hpp"

namespace planemap::simulation {
namespace {

constexpr PinholeIntrinsics kCoarseKinect{160, 120, 146.25, 146.25, 80.0, 60.0};

SimulationConfig config_of(const std::string& scene, std::uint64_t seed = 1) {
  SimulationConfig config;
  config.scene = scene;
  config.seed = seed;
  config.intrinsics = kCoarseKinect;
  return config;
}

std::vector<std::string> special_rooms() {
  std::vector<std::string> names;
  for (const SceneInfo& scene : scenes_with_an_end()) {
    if (scene.name != "apartment") names.emplace_back(scene.name);
  }
  return names;
}

/// The surface of that name.
const Surface& named(const SimulatedSource& source, const std::string& name) {
  const auto found = std::find_if(source.truth().begin(), source.truth().end(),
                                  [&name](const Surface& surface) { return surface.name == name; });
  if (found == source.truth().end()) throw std::runtime_error("no surface '" + name + "'");
  return *found;
}

double degrees_between(const Surface& a, const Surface& b) {
  const Eigen::Vector3d& m = a.plane.normal();
  const Eigen::Vector3d& n = b.plane.normal();
  return std::atan2(m.cross(n).norm(), m.dot(n)) * 180.0 / std::numbers::pi;
}

/// Distance of a surface's first corner before another surface's plane.
double before_m(const Surface& surface, const Surface& other) {
  return other.plane.signed_distance_m(surface.pieces_m.front().front());
}

class SpecialRoom : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, SpecialRoom, testing::ValuesIn(special_rooms()), [](const auto& name) {
  std::string words = name.param;
  std::replace(words.begin(), words.end(), '-', '_');
  return words;
});

TEST_P(SpecialRoom, RenderedDepthIsThatOfTheTruthInEachPixel) {
  SimulationConfig config = config_of(GetParam());
  config.frames = 10;
  SimulatedSource source(config);
  std::size_t compared = 0;
  while (source.next()) {
    const Eigen::Isometry3d& pose = source.true_T_world_sensor();
    for (int v = 0; v < 120; v += 2) {
      for (int u = 0; u < 160; u += 2) {
        const std::size_t at = static_cast<std::size_t>(v) * 160 + u;
        const Eigen::Vector3d ray = pose.linear() * ray_through(config.intrinsics, u, v);
        const Hit hit = cast_ray(source.truth(), pose.translation(), ray, /*both_sides=*/false);
        ASSERT_NE(hit.surface, kNoSurface) << "the room has a hole";
        ASSERT_NEAR(source.true_depth_m()[at] / hit.along, 1.0, 1e-5) << u << " " << v;
        const Surface& seen = source.truth().at(source.label_image()[at] - 1U);
        ASSERT_NEAR(seen.plane.signed_distance_m(pose.translation() + hit.along * ray), 0.0, 1e-5) << seen.name;
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 10U * 60U * 80U);
}

TEST_P(SpecialRoom, SurfacesLieOnTheirPlanesAndRunCounterClockwise) {
  SimulatedSource source(config_of(GetParam()));
  SurfaceId id = 0;
  for (const Surface& surface : source.truth()) {
    EXPECT_EQ(surface.id, ++id);
    for (const ConvexPiece& piece_m : surface.pieces_m) {
      for (const Eigen::Vector3d& corner_m : piece_m) {
        EXPECT_NEAR(surface.plane.signed_distance_m(corner_m), 0.0, 1e-9) << surface.name;
      }
      const Eigen::Vector3d turn = (piece_m[1] - piece_m[0]).cross(piece_m[2] - piece_m[1]);
      EXPECT_GT(turn.dot(surface.plane.normal()), 0.0) << surface.name;
    }
  }
}

TEST_P(SpecialRoom, LiesElsewhereForEachSeedAndNeverAlongTheGrid) {
  std::vector<Eigen::Vector3d> normals;
  for (const std::uint64_t seed : {1, 2, 3}) {
    SimulatedSource source(config_of(GetParam(), seed));
    const Eigen::Vector3d up = named(source, "floor").plane.normal();
    EXPECT_NEAR(std::acos(up.z()), 0.0175, 1e-9) << "tilted by a degree";
    normals.push_back(named(source, "wall 1").plane.normal());
    const double off_axis_rad = std::acos(std::min(1.0, normals.back().cwiseAbs().maxCoeff()));
    EXPECT_GT(off_axis_rad, 0.0175) << seed;
  }
  EXPECT_LT(std::abs(normals[0].dot(normals[1])), 0.9999);
  EXPECT_LT(std::abs(normals[1].dot(normals[2])), 0.9999);
}

TEST_P(SpecialRoom, CameraKeepsClearOfEverythingAndStaysInside) {
  SimulatedSource source(config_of(GetParam()));
  EXPECT_GE(*source.size(), 20U);
  EXPECT_LE(*source.size(), 120U);
  while (source.next()) {
    const Eigen::Vector3d& position_m = source.true_T_world_sensor().translation();
    for (int k = 0; k < 24; ++k) {
      const double angle_rad = k * 2.0 * std::numbers::pi / 24;
      for (const double rise : {-1.0, 0.0, 1.0}) {
        const Eigen::Vector3d direction(std::cos(angle_rad), std::sin(angle_rad), rise);
        const Hit hit = cast_ray(source.truth(), position_m, direction.normalized(), /*both_sides=*/true);
        ASSERT_NE(hit.surface, kNoSurface) << "the camera is outside";
        ASSERT_TRUE(hit.from_front) << "the camera is inside " << source.truth()[hit.surface - 1U].name;
        ASSERT_GT(hit.along, 0.2) << "the camera is too near to " << source.truth()[hit.surface - 1U].name;
      }
    }
  }
}

TEST(SpecialRooms, TheLeafMakesTenDegreesWithItsWallAndTouchesItAtTheHinge) {
  SimulatedSource source(config_of("door-ajar"));
  const Surface& leaf = named(source, "door leaf 1 front");
  const Surface& wall = named(source, "wall 5");
  EXPECT_NEAR(degrees_between(leaf, wall), 10.0, 1e-6);
  std::vector<double> before_wall_m;
  for (const Eigen::Vector3d& corner_m : leaf.pieces_m.front()) {
    before_wall_m.push_back(wall.plane.signed_distance_m(corner_m));
  }
  std::sort(before_wall_m.begin(), before_wall_m.end());
  EXPECT_NEAR(before_wall_m.front(), 0.0, 1e-9);
  EXPECT_NEAR(before_wall_m.back(), 0.88 * std::sin(10.0 * std::numbers::pi / 180.0), 1e-9);
}

TEST(SpecialRooms, ThinWallsHaveTwoFacesTenCentimetresApart) {
  SimulatedSource source(config_of("thin-walls"));
  for (const std::string wall : {"thin wall 1", "thin wall 2"}) {
    const Surface& left = named(source, wall + " left side");
    const Surface& right = named(source, wall + " right side");
    EXPECT_NEAR(degrees_between(left, right), 180.0, 1e-6);
    EXPECT_NEAR(before_m(left, right), -0.10, 1e-9);
  }
}

TEST(SpecialRooms, CabinetFrontsAreSixCentimetresBeforeTheirWalls) {
  SimulatedSource source(config_of("cabinet-fronts"));
  const auto check = [&source](const char* front, const char* wall) {
    EXPECT_NEAR(degrees_between(named(source, front), named(source, wall)), 0.0, 1e-6);
    EXPECT_NEAR(before_m(named(source, front), named(source, wall)), 0.06, 1e-9);
  };
  check("tall cabinet 1 front", "wall 4");
  check("low cabinet 1 front", "wall 2");
}

TEST(SpecialRooms, TableTopsAreOfOneHeightAndFourCentimetresThick) {
  SimulatedSource source(config_of("table-tops"));
  EXPECT_NEAR(before_m(named(source, "table 1 top"), named(source, "table 2 top")), 0.0, 1e-9);
  for (const std::string table : {"table 1", "table 2"}) {
    EXPECT_NEAR(before_m(named(source, table + " top"), named(source, "floor")), 0.74, 1e-9);
    EXPECT_NEAR(before_m(named(source, table + " underside"), named(source, table + " top")), -0.04, 1e-9);
    EXPECT_NEAR(degrees_between(named(source, table + " underside"), named(source, table + " top")), 180.0, 1e-6);
    EXPECT_NEAR(area_m2(named(source, table + " front")), 1.4 * 0.04, 1e-9);
  }
}

TEST(SpecialRooms, StairsRiseAndGoOnStepByStep) {
  SimulatedSource source(config_of("stairs"));
  const Surface& floor = named(source, "floor");
  for (int i = 1; i <= 5; ++i) {
    const Surface& tread = named(source, i == 5 ? "landing" : "tread " + std::to_string(i));
    const Surface& riser = named(source, "riser " + std::to_string(i));
    EXPECT_NEAR(before_m(tread, floor), 0.17 * i, 1e-9);
    EXPECT_NEAR(degrees_between(tread, riser), 90.0, 1e-6);
    EXPECT_NEAR(before_m(riser, named(source, "riser 1")), -0.28 * (i - 1), 1e-9);
    EXPECT_NEAR(area_m2(riser), 0.17 * 1.8, 1e-9);
  }
}

TEST(SpecialRooms, RampRisesOneInTwelveFromFloorToFloor) {
  SimulatedSource source(config_of("ramp"));
  const double rise_deg = std::atan(1.0 / 12.0) * 180.0 / std::numbers::pi;
  EXPECT_NEAR(degrees_between(named(source, "ramp"), named(source, "floor")), rise_deg, 1e-6);
  EXPECT_NEAR(before_m(named(source, "upper floor"), named(source, "floor")), 0.2, 1e-9);
  EXPECT_NEAR(before_m(named(source, "ramp"), named(source, "floor")), 0.0, 1e-9);
}

TEST(SpecialRooms, PillarIsSquareAndColumnIsRound) {
  SimulatedSource pillar(config_of("pillar"));
  EXPECT_NEAR(before_m(named(pillar, "pillar front"), named(pillar, "pillar back")), -0.4, 1e-9);
  EXPECT_NEAR(degrees_between(named(pillar, "pillar front"), named(pillar, "pillar left side")), 90.0, 1e-6);

  SimulatedSource column(config_of("column"));
  std::size_t facets = 0;
  for (const Surface& surface : column.truth()) {
    if (!surface.facet) continue;
    ++facets;
    EXPECT_LT(area_m2(surface), 0.1);
    // Opposite facets are a diameter apart, less what a facet's middle is off the circle.
    const Surface& first = named(column, "column facet 1");
    const Surface& opposite = named(column, "column facet 19");
    EXPECT_NEAR(before_m(opposite, first), -0.4 * std::cos(std::numbers::pi / 36.0), 1e-9);
  }
  EXPECT_EQ(facets, 36U);
  const auto truth = nlohmann::json::parse(truth_json(column.truth()));
  EXPECT_EQ(truth.at("planes").size(), 6U) << "floor, ceiling and walls: facets are no planes";
}

TEST(SpecialRooms, CorridorShowsItsLongWallsAtSixtyDegreesAndMore) {
  SimulatedSource source(config_of("corridor"));
  const Surface& wall = named(source, "wall 1");
  double least_incidence_deg = 90.0;
  std::size_t pixels = 0;
  while (source.next()) {
    const Eigen::Isometry3d& pose = source.true_T_world_sensor();
    for (std::size_t at = 0; at < source.label_image().size(); ++at) {
      if (source.label_image()[at] != wall.id) continue;
      const Eigen::Vector3d ray =
          pose.linear() * ray_through(kCoarseKinect, static_cast<int>(at % 160), static_cast<int>(at / 160));
      const double cosine = -ray.normalized().dot(wall.plane.normal());
      least_incidence_deg = std::min(least_incidence_deg, std::acos(cosine) * 180.0 / std::numbers::pi);
      ++pixels;
    }
  }
  EXPECT_GT(pixels, 10'000U);
  EXPECT_GT(least_incidence_deg, 58.0);
}

TEST(SpecialRooms, CeilingIsSeenInThreeFrames) {
  SimulatedSource source(config_of("ceiling-glimpse"));
  const SurfaceId ceiling = named(source, "ceiling").id;
  std::size_t frames = 0;
  while (source.next()) {
    frames += std::count(source.label_image().begin(), source.label_image().end(), ceiling) > 0 ? 1U : 0U;
  }
  EXPECT_EQ(frames, 3U);
}

TEST(SpecialRooms, AnUnknownNameIsRefused) {
  EXPECT_THROW(SimulatedSource(config_of("castle")), std::invalid_argument);
}

/// Share of a surface of which returns come from at most 5 m.
double seen_share(const std::string& scene, const std::string& name) {
  SimulatedSource source(config_of(scene));
  const Surface& surface = named(source, name);
  constexpr double kPatchM = 0.08;
  const Eigen::Vector3d u = surface.plane.normal().unitOrthogonal();
  const Eigen::Vector3d v = surface.plane.normal().cross(u);
  std::vector<std::pair<long, long>> patches;
  while (const auto frame = source.next()) {
    for (std::size_t at = 0; at < frame->scan.depth.size(); ++at) {
      const double depth_m = static_cast<double>(source.true_depth_m()[at]);
      if (source.label_image()[at] != surface.id || frame->scan.depth[at] == kNoReturn || depth_m > 5.0) continue;
      const Eigen::Vector3d p_m =
          source.true_T_world_sensor() *
          (depth_m * ray_through(kCoarseKinect, static_cast<int>(at % 160), static_cast<int>(at / 160)));
      patches.emplace_back(std::lround(p_m.dot(u) / kPatchM), std::lround(p_m.dot(v) / kPatchM));
    }
    std::sort(patches.begin(), patches.end());
    patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
  }
  return kPatchM * kPatchM * static_cast<double>(patches.size()) / area_m2(surface);
}

TEST(SpecialRooms, ToursShowWhatTheRoomsAreAbout) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> shown = {
      {"door-ajar", {"door leaf 1 front"}},
      {"thin-walls",
       {"thin wall 1 left side", "thin wall 1 right side", "thin wall 2 left side", "thin wall 2 right side"}},
      {"cabinet-fronts", {"tall cabinet 1 front", "low cabinet 1 front"}},
      {"table-tops", {"table 1 top", "table 1 underside", "table 2 top", "table 2 underside"}},
      {"stairs", {"tread 1", "tread 4", "riser 1", "riser 5", "landing"}},
      {"ramp", {"ramp", "upper floor"}},
      {"pillar", {"pillar front", "pillar back", "pillar left side", "pillar right side"}},
      {"column", {"column facet 1", "column facet 10", "column facet 19", "column facet 28"}},
      {"corridor", {"wall 1", "wall 2"}},
      {"ceiling-glimpse", {"ceiling"}}};
  ASSERT_EQ(shown.size(), special_rooms().size());
  for (const auto& [scene, names] : shown) {
    for (const std::string& name : names) {
      EXPECT_GT(seen_share(scene, name), scene == "ceiling-glimpse" ? 0.3 : 0.6) << scene << ": " << name;
    }
  }
}

}  // namespace
}  // namespace planemap::simulation

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/simulation/truth_file.hpp>
#include <set>
#include <tuple>

#include "kinect_bridge_test_scene.hpp"

namespace planemap::simulation {
namespace {

SimulationConfig small_config(std::uint64_t seed, std::size_t frames) {
  SimulationConfig config;
  config.seed = seed;
  config.frames = frames;
  config.intrinsics = kSmallKinect;
  return config;
}

class Apartment : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Apartment, testing::Values(1, 2, 3, 5, 8, 13, 1000000007));

TEST_P(Apartment, HasEverythingThatItPromises) {
  SimulatedSource source(small_config(GetParam(), 1));
  std::map<std::string, int> count;  // by the first word of the name
  SurfaceId id = 0;
  for (const Surface& surface : source.truth()) {
    EXPECT_EQ(surface.id, ++id);
    EXPECT_FALSE(surface.name.empty());
    ++count[surface.name.substr(0, surface.name.find(' '))];
  }
  EXPECT_EQ(count["floor"], 1);
  EXPECT_EQ(count["ceiling"], 1);
  EXPECT_GE(count["wall"], 4 + 2 * 3) << "four outer walls and three thin ones with two faces each";
  EXPECT_GE(count["door"], 3 * 3) << "jambs and lintels of three doors";
  for (const char* thing : {"table", "low", "tall", "slanted"}) EXPECT_GT(count[thing], 0) << thing;
}

TEST_P(Apartment, SurfacesLieOnTheirPlanesAndFaceGravityAsTheirClassSays) {
  SimulatedSource source(small_config(GetParam(), 1));
  const Eigen::Vector3d up = -*source.gravity_direction();
  EXPECT_NEAR(std::acos(up.z()), 0.0175, 1e-9) << "the apartment is tilted by a degree";
  for (const Surface& surface : source.truth()) {
    EXPECT_GT(area_m2(surface), 1e-4) << surface.name;
    for (const ConvexPiece& piece_m : surface.pieces_m) {
      for (const Eigen::Vector3d& corner_m : piece_m) {
        EXPECT_NEAR(surface.plane.signed_distance_m(corner_m), 0.0, 1e-9) << surface.name;
      }
      const Eigen::Vector3d turn = (piece_m[1] - piece_m[0]).cross(piece_m[2] - piece_m[1]);
      EXPECT_GT(turn.dot(surface.plane.normal()), 0.0) << surface.name << " runs clockwise";
    }
    const double rise = surface.plane.normal().dot(up);
    switch (surface.plane_class) {
      case PlaneClass::kFloor:
      case PlaneClass::kTable:
        EXPECT_NEAR(rise, 1.0, 1e-9) << surface.name;
        break;
      case PlaneClass::kCeiling:
        EXPECT_NEAR(rise, -1.0, 1e-9) << surface.name;
        break;
      case PlaneClass::kWall:
        EXPECT_NEAR(rise, 0.0, 1e-9) << surface.name;
        break;
      case PlaneClass::kSlope:
        EXPECT_TRUE(rise > 0.3 && rise < 0.9) << surface.name << " " << rise;
        break;
      case PlaneClass::kOther:
        break;
    }
  }
}

TEST_P(Apartment, EveryLargeSurfaceIsSeenInATourOf150Frames) {
  SimulationConfig config = small_config(GetParam(), 150);
  config.intrinsics = {160, 120, 146.25, 146.25, 80.0, 60.0};
  SimulatedSource source(config);
  constexpr double kPatchM = 0.1;
  std::vector<std::set<std::tuple<long, long, long>>> patches(source.truth().size() + 1);
  while (const auto frame = source.next()) {
    for (std::size_t at = 0; at < frame->scan.depth.size(); ++at) {
      if (frame->scan.depth[at] == kNoReturn || source.true_depth_m()[at] > 5.0F) continue;
      const int u = static_cast<int>(at % 160);
      const int v = static_cast<int>(at / 160);
      const Eigen::Vector3d p_m = source.true_T_world_sensor() * (static_cast<double>(source.true_depth_m()[at]) *
                                                                  ray_through(config.intrinsics, u, v));
      const Eigen::Vector3d steps = p_m / kPatchM;
      patches[source.label_image()[at]].emplace(std::lround(steps.x()), std::lround(steps.y()), std::lround(steps.z()));
    }
  }
  std::size_t large = 0;
  for (const Surface& surface : source.truth()) {
    if (area_m2(surface) <= 0.25) continue;
    ++large;
    // A plane meets at least one patch for each square of a patch's side; a third of a surface may be hidden.
    const double seen_m2 = kPatchM * kPatchM * static_cast<double>(patches[surface.id].size());
    EXPECT_GE(seen_m2, 0.6 * area_m2(surface)) << surface.name;
  }
  EXPECT_GE(large, 20u);
}

TEST_P(Apartment, CameraKeepsClearOfEverythingAndStaysInside) {
  SimulatedSource source(small_config(GetParam(), 400));
  Eigen::Isometry3d last = Eigen::Isometry3d::Identity();
  double last_step_m = 0.0;
  for (int frame = 0; source.next(); ++frame) {
    const Eigen::Isometry3d& pose = source.true_T_world_sensor();
    for (int k = 0; k < 24; ++k) {
      const double angle_rad = k * 2.0 * 3.141592653589793 / 24;
      for (const double rise : {-0.5, 0.0, 0.5}) {
        const Eigen::Vector3d direction = Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), rise).normalized();
        const Hit hit = cast_ray(source.truth(), pose.translation(), direction, /*both_sides=*/true);
        ASSERT_NE(hit.surface, kNoSurface) << "the camera is outside at frame " << frame;
        ASSERT_TRUE(hit.from_front) << "the camera is inside " << source.truth()[hit.surface - 1u].name;
        ASSERT_GT(hit.along, 0.1) << "the camera is too near to " << source.truth()[hit.surface - 1u].name;
      }
    }
    const double height_m = source.truth()[0].plane.signed_distance_m(pose.translation());
    ASSERT_TRUE(height_m > 1.0 && height_m < 1.3) << height_m;
    if (frame > 0) {
      last_step_m = (pose.translation() - last.translation()).norm();
      ASSERT_LT(last_step_m, 0.5 * source.tour_s() / 400) << "faster than half a metre a second";
    }
    last = pose;
  }
}

TEST(SimulatedSource, MovesSmoothlyAtTrueSpeedAndRoundTheEnd) {
  SimulationConfig config = small_config(4, 1);
  config.frames.reset();
  config.loop = true;
  config.intrinsics = {8, 6, 7.3, 7.3, 4.0, 3.0};
  SimulatedSource source(config);
  EXPECT_FALSE(source.size());
  const auto frames = static_cast<int>(source.tour_s() * 30.0) + 60;  // beyond the end
  Eigen::Isometry3d last = Eigen::Isometry3d::Identity();
  for (int frame = 0; frame < frames; ++frame) {
    ASSERT_TRUE(source.next());
    const Eigen::Isometry3d& pose = source.true_T_world_sensor();
    if (frame > 0) {
      ASSERT_LT((pose.translation() - last.translation()).norm() * 30.0, 0.5) << frame;
      ASSERT_LT(Eigen::AngleAxisd(last.linear().transpose() * pose.linear()).angle() * 30.0, 2.0) << frame;
    }
    last = pose;
  }
}

TEST(SimulatedSource, SameSeedSameBytesOtherSeedOthers) {
  const auto frames_of = [](std::uint64_t seed) {
    SimulationConfig config = small_config(seed, 5);
    config.pose_noise = {0.01, 0.01, 1.0};
    SimulatedSource source(config);
    std::vector<sources::Frame> frames;
    while (auto frame = source.next()) frames.push_back(std::move(*frame));
    return frames;
  };
  const auto once = frames_of(6);
  const auto again = frames_of(6);
  const auto other = frames_of(7);
  ASSERT_EQ(once.size(), 5u);
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].scan.depth, again[i].scan.depth);
    EXPECT_EQ(once[i].T_world_sensor.matrix(), again[i].T_world_sensor.matrix());
    EXPECT_NE(once[i].scan.depth, other[i].scan.depth);
    EXPECT_EQ(once[i].scan.utime, kFirstUtime + std::llround(static_cast<double>(i) / 30.0 * 1e6));
  }
}

TEST(SimulatedSource, FrameIsTheTrueDepthWithNoiseOfThatDepth) {
  SimulationConfig config = small_config(9, 10);
  config.intrinsics = kKinect;
  SimulatedSource source(config);
  double squares = 0.0;
  std::size_t count = 0;
  while (const auto frame = source.next()) {
    for (std::size_t at = 0; at < frame->scan.depth.size(); ++at) {
      if (frame->scan.depth[at] == kNoReturn) continue;
      const double z_m = static_cast<double>(source.true_depth_m()[at]);
      const double sigma_m = z_m * z_m * std::hypot(1.425e-3, 0.125 / (585.0 * 0.075) / std::sqrt(12.0));
      squares += std::pow((1e-3 * frame->scan.depth[at] - z_m) / sigma_m, 2);
      ++count;
    }
  }
  ASSERT_GT(count, 1'000'000u);
  EXPECT_NEAR(squares / static_cast<double>(count), 1.0, 0.03);
}

/// Errors of the published positions, and how alike those of successive frames are.
TEST(SimulatedSource, PoseNoiseHasItsSizeAndWandersInItsTime) {
  for (const double correlation_s : {0.0, 0.5}) {
    SimulationConfig config = small_config(2, 3000);
    config.intrinsics = {8, 6, 7.3, 7.3, 4.0, 3.0};
    config.pose_noise = {0.02, 0.005, correlation_s};
    SimulatedSource source(config);
    double position_m2 = 0.0;
    double rotation_rad2 = 0.0;
    double successive_m2 = 0.0;
    Eigen::Vector3d last_m = Eigen::Vector3d::Zero();
    while (const auto frame = source.next()) {
      const Eigen::Isometry3d error = source.true_T_world_sensor().inverse() * frame->T_world_sensor;
      position_m2 += error.translation().squaredNorm() / 3.0;
      rotation_rad2 += std::pow(Eigen::AngleAxisd(error.linear()).angle(), 2) / 3.0;
      successive_m2 += error.translation().dot(last_m) / 3.0;
      last_m = error.translation();
    }
    const double tolerance = correlation_s > 0.0 ? 0.15 : 0.05;  // 3000 frames of 15 correlated ones are 200
    EXPECT_NEAR(std::sqrt(position_m2 / 3000.0) / 0.02, 1.0, tolerance);
    EXPECT_NEAR(std::sqrt(rotation_rad2 / 3000.0) / 0.005, 1.0, tolerance);
    const double expected = correlation_s > 0.0 ? std::exp(-1.0 / 30.0 / correlation_s) : 0.0;
    EXPECT_NEAR(successive_m2 / position_m2, expected, 0.05);
  }
}

TEST(SimulatedSource, RefusesSettingsThatMeanNothing) {
  EXPECT_THROW(SimulatedSource(small_config(1, 0)), std::invalid_argument);
  SimulationConfig config = small_config(1, 1);
  config.rate_hz = 0.0;
  EXPECT_THROW(SimulatedSource{config}, std::invalid_argument);
  config = small_config(1, 1);
  config.time_lapse = 0.0;
  EXPECT_THROW(SimulatedSource{config}, std::invalid_argument);
  config = small_config(1, 1);
  config.pose_noise.sigma_m = -1.0;
  EXPECT_THROW(SimulatedSource{config}, std::invalid_argument);
}

TEST(TruthFile, HoldsEverySurfaceInTheSchemaOfPlanes) {
  SimulatedSource source(small_config(3, 1));
  const auto document = nlohmann::json::parse(truth_json(source.truth()));
  EXPECT_EQ(document.at("frame"), "world");
  ASSERT_EQ(document.at("planes").size(), source.truth().size());
  for (std::size_t i = 0; i < source.truth().size(); ++i) {
    const Surface& surface = source.truth()[i];
    const auto& plane = document.at("planes")[i];
    EXPECT_EQ(plane.at("id"), surface.id);
    EXPECT_EQ(plane.at("class"), name_of(surface.plane_class));
    EXPECT_EQ(plane.at("d"), surface.plane.d());
    EXPECT_EQ(plane.at("covariance").size(), 16u);
    EXPECT_NEAR(plane.at("area").get<double>(), area_m2(surface), 1e-12);
    EXPECT_EQ(plane.at("polygons").size(), surface.pieces_m.size());
    const auto centroid = plane.at("centroid").get<std::vector<double>>();
    EXPECT_NEAR(surface.plane.signed_distance_m({centroid[0], centroid[1], centroid[2]}), 0.0, 1e-9);
    for (const char* key : {"cellCount", "pointCount", "quality", "firstSeenUtime", "lastSeenUtime", "coplanar"}) {
      EXPECT_TRUE(plane.contains(key)) << key;
    }
  }
}

}  // namespace
}  // namespace planemap::simulation

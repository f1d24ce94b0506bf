// The endless building: what is rendered agrees with its truth, the robot can go through it, and it costs the same
// however far one has come.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <planemap/simulation/scenes.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <set>
#include <string>
#include <vector>

#include "building/building.hpp"
#include "kinect_bridge_test_scene.hpp"

namespace planemap::simulation {
namespace {

constexpr PinholeIntrinsics kTinyKinect{40, 30, 36.5625, 36.5625, 20.0, 15.0};

SimulationConfig config_of(std::size_t frames, double time_lapse, std::uint64_t seed = 1) {
  SimulationConfig config;
  config.scene = kBuildingScene;
  config.seed = seed;
  config.frames = frames;
  config.time_lapse = time_lapse;
  config.intrinsics = kTinyKinect;
  return config;
}

const Surface& named(const std::vector<Surface>& truth, const std::string& name) {
  const auto found = std::find_if(truth.begin(), truth.end(), [&](const Surface& s) { return s.name == name; });
  if (found == truth.end()) throw std::runtime_error("no surface '" + name + "'");
  return *found;
}

/// A frame and what is known about it.
struct Seen {
  Eigen::Isometry3d T_world_sensor;
  std::vector<SurfaceId> labels;
  std::vector<float> depth_m;
};

TEST(Building, RenderedDepthIsThatOfTheTruthInEachPixel) {
  const SimulationConfig config = config_of(60, 150.0);
  SimulatedSource source(config);
  std::vector<Seen> frames;
  while (source.next()) {
    const auto labels = source.label_image();
    const auto depth_m = source.true_depth_m();
    frames.push_back({source.true_T_world_sensor(), {labels.begin(), labels.end()}, {depth_m.begin(), depth_m.end()}});
  }
  ASSERT_EQ(frames.size(), 60U);
  const std::vector<Surface> truth = source.truth();
  std::size_t compared = 0;
  for (const Seen& frame : frames) {
    for (int v = 0; v < kTinyKinect.height; ++v) {
      for (int u = 0; u < kTinyKinect.width; ++u) {
        const std::size_t at = static_cast<std::size_t>(v) * kTinyKinect.width + u;
        const Eigen::Vector3d ray = frame.T_world_sensor.linear() * ray_through(kTinyKinect, u, v);
        const Hit hit = cast_ray(truth, frame.T_world_sensor.translation(), ray, /*both_sides=*/false);
        if (frame.labels[at] == kNoSurface) {  // too far away
          ASSERT_GT(hit.along, config.depth_noise.max_range_m);
          continue;
        }
        ASSERT_NEAR(frame.depth_m[at] / hit.along, 1.0, 1e-5) << u << " " << v;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 60U * 900U);
}

TEST(Building, TruthIsWhatWasSeenNamedAsItsLabelsAre) {
  SimulatedSource source(config_of(100, 60.0));
  EXPECT_TRUE(source.truth().empty());
  std::set<SurfaceId> labels;
  while (source.next()) labels.insert(source.label_image().begin(), source.label_image().end());
  labels.erase(kNoSurface);
  std::set<SurfaceId> ids;
  for (const Surface& surface : source.truth()) {
    EXPECT_GT(surface.id, ids.empty() ? 0 : *ids.rbegin());
    ids.insert(surface.id);
    ASSERT_FALSE(surface.pieces_m.empty()) << surface.name;
    for (const ConvexPiece& piece_m : surface.pieces_m) {
      for (const Eigen::Vector3d& corner_m : piece_m) {
        EXPECT_NEAR(surface.plane.signed_distance_m(corner_m), 0.0, 1e-9) << surface.name;
      }
      const Eigen::Vector3d turn = (piece_m[1] - piece_m[0]).cross(piece_m[2] - piece_m[1]);
      EXPECT_GT(turn.dot(surface.plane.normal()), 0.0) << surface.name;
    }
  }
  EXPECT_EQ(ids, labels);
}

TEST(Building, HasRoomsOfManySizesWithFurnitureAndOneFloorThroughAll) {
  SimulatedSource source(config_of(1000, 15.0 * 4.0));
  while (source.next()) {
  }
  const std::vector<Surface> truth = source.truth();
  const Surface& floor = named(truth, "floor");
  EXPECT_GT(area_m2(floor), 1700.0) << "after 2,000 seconds";
  std::set<int> square_metres;
  for (const ConvexPiece& piece_m : floor.pieces_m) square_metres.insert(static_cast<int>(area_m2(piece_m)));
  EXPECT_GT(square_metres.size(), 12U);
  for (const char* thing : {"table", "cabinet", "door leaf", "jamb"}) {
    EXPECT_GE(std::count_if(truth.begin(), truth.end(),
                            [&](const Surface& s) { return s.name.find(thing) != std::string::npos; }),
              4)
        << thing;
  }
}

TEST(Building, LiesElsewhereForEachSeedAndNeverAlongTheGrid) {
  std::vector<Eigen::Vector3d> normals;
  for (const std::uint64_t seed : {1, 2, 3}) {
    SimulatedSource source(config_of(100, 15.0, seed));
    while (source.next()) {
    }
    const std::vector<Surface> truth = source.truth();
    EXPECT_NEAR(std::acos(named(truth, "floor").plane.normal().z()), 0.0175, 1e-9) << "tilted by a degree";
    EXPECT_NEAR(source.gravity_direction()->dot(named(truth, "floor").plane.normal()), -1.0, 1e-12);
    normals.push_back(named(truth, "wing 1 wall 1").plane.normal());
    EXPECT_GT(std::acos(std::min(1.0, normals.back().cwiseAbs().maxCoeff())), 0.0175) << seed;
  }
  EXPECT_LT(std::abs(normals[0].dot(normals[1])), 0.9999);
  EXPECT_LT(std::abs(normals[1].dot(normals[2])), 0.9999);
}

TEST(Building, SameSeedGivesTheSameFrames) {
  SimulatedSource one(config_of(100, 30.0));
  SimulatedSource other(config_of(100, 30.0));
  while (const auto frame = one.next()) {
    const auto again = other.next();
    ASSERT_TRUE(again);
    EXPECT_EQ(frame->scan.depth, again->scan.depth);
    EXPECT_TRUE(frame->T_world_sensor.isApprox(again->T_world_sensor, 0.0));
  }
}

TEST(Building, CameraMovesSmoothlyAndKeepsClearOfEverything) {
  constexpr double kStepS = 0.5;
  constexpr double kSightM = 8.0;
  Building building(/*seed=*/5, kSightM);
  std::vector<Surface> near;
  Eigen::Isometry3d last = building.T_world_sensor(0.0);
  for (double time_s = 0.0; time_s < 3000.0; time_s += kStepS) {
    const Eigen::Isometry3d T_world_sensor = building.T_world_sensor(time_s);
    ASSERT_LT((T_world_sensor.translation() - last.translation()).norm(), 0.5 * kStepS) << time_s;
    const Eigen::AngleAxisd turn(last.linear().transpose() * T_world_sensor.linear());
    ASSERT_LT(std::abs(turn.angle()), 1.6 * kStepS) << time_s;
    last = T_world_sensor;
    if (auto pieces = building.look_from(T_world_sensor.translation())) near = std::move(*pieces);
    for (int k = 0; k < 12; ++k) {
      const double angle_rad = (k + 0.5 * std::fmod(time_s, 1.0)) * 2.0 * std::numbers::pi / 12;
      const Eigen::Vector3d direction(std::cos(angle_rad), std::sin(angle_rad), 0.0);
      const Hit hit = cast_ray(near, T_world_sensor.translation(), direction, /*both_sides=*/true);
      if (hit.along > kSightM) continue;  // farther away than the camera sees
      ASSERT_TRUE(hit.from_front) << "the camera is inside something at " << time_s << " s";
      ASSERT_GT(hit.along, 0.2) << "the camera is too near to something at " << time_s << " s";
    }
  }
}

TEST(Building, CostsTheSameHoweverFarOneHasCome) {
  constexpr double kStepS = 2.0;
  Building building(/*seed=*/2, /*sight_m=*/8.4);
  std::size_t most_wings = 0;
  std::vector<double> pieces_at_first;
  std::vector<double> pieces_at_last;
  constexpr double kEndS = 12000.0;
  for (double time_s = 0.0; time_s < kEndS; time_s += kStepS) {
    const auto near = building.look_from(building.T_world_sensor(time_s).translation());
    most_wings = std::max(most_wings, building.kept_wings());
    if (near && time_s < 0.1 * kEndS) pieces_at_first.push_back(static_cast<double>(near->size()));
    if (near && time_s > 0.9 * kEndS) pieces_at_last.push_back(static_cast<double>(near->size()));
  }
  EXPECT_LE(most_wings, 3U);
  ASSERT_GT(pieces_at_first.size(), 100U);
  ASSERT_GT(pieces_at_last.size(), 100U);
  const double most_at_first = *std::max_element(pieces_at_first.begin(), pieces_at_first.end());
  EXPECT_LT(*std::max_element(pieces_at_last.begin(), pieces_at_last.end()), 1.5 * most_at_first);
  const double y_m = (building.T_world_building().inverse() * building.T_world_sensor(kEndS)).translation().y();
  EXPECT_GT(y_m, 10.0 * kWingPitchM) << "ten wings are 6,000 square metres";
}

}  // namespace
}  // namespace planemap::simulation

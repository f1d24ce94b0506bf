#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <planemap/simulation/kinect_sensor.hpp>
#include <planemap/simulation/renderer.hpp>
#include <planemap/simulation/simulated_source.hpp>

#include "kinect_bridge_test_scene.hpp"

namespace planemap::simulation {
namespace {

TEST(Renderer, WallAcrossTheAxisHasItsDepthInEachPixelThatItCovers) {
  // 2 m away, from x = -1 m to x = 0.5 m, y = -0.4 to 0.4: columns 320 + 585/2 x, rows 240 + 585/2 y.
  const std::vector<Surface> scene = {wall_at(7, 2.0, -1.0, 0.5, 0.4)};
  Renderer renderer(scene, kKinect);
  const RenderedImage& image = renderer.render(Eigen::Isometry3d::Identity());
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const bool covered = u >= 27.5 && u < 466.25 && v >= 123.0 && v < 357.0;
      const std::size_t at = static_cast<std::size_t>(v) * 640 + u;
      ASSERT_EQ(image.surface[at], covered ? 7 : kNoSurface) << u << " " << v;
      ASSERT_FLOAT_EQ(image.depth_m[at], covered ? 2.0F : 0.0F) << u << " " << v;
    }
  }
  EXPECT_FLOAT_EQ(image.cos_incidence[240 * 640 + 320], 1.0F);
  // 120 columns to the left the line of sight leans by atan(120/585).
  EXPECT_NEAR(image.cos_incidence[240 * 640 + 200], 585.0 / std::hypot(585.0, 120.0), 1e-6);
}

TEST(Renderer, SlantedWallHasTheDepthOfItsPlane) {
  // z = 2 + x: depth 2 / (1 - (u - 320)/585).
  Surface wall;
  wall.id = 1;
  wall.plane = Plane::through({0.0, 0.0, 2.0}, Eigen::Vector3d(1.0, 0.0, -1.0).normalized());
  wall.pieces_m = {{{-1.5, -9.0, 0.5}, {-1.5, 9.0, 0.5}, {3.0, 9.0, 5.0}, {3.0, -9.0, 5.0}}};
  const std::vector<Surface> scene = {wall};
  Renderer renderer(scene, kKinect);
  const RenderedImage& image = renderer.render(Eigen::Isometry3d::Identity());
  for (const int u : {0, 100, 320, 500, 639}) {
    EXPECT_NEAR(image.depth_m[240 * 640 + static_cast<std::size_t>(u)], 2.0 / (1.0 - (u - 320) / 585.0), 1e-5) << u;
  }
}

TEST(Renderer, NearerSurfaceWinsAndBacksAreNotSeen) {
  Surface back = wall_at(3, 1.0, -9.0, 9.0, 9.0);
  back.plane = Plane::through({0.0, 0.0, 1.0}, Eigen::Vector3d::UnitZ());
  for (const bool near_first : {true, false}) {
    std::vector<Surface> scene = {wall_at(1, 1.5, 0.0, 9.0, 9.0), wall_at(2, 3.0, -9.0, 9.0, 9.0), back};
    if (!near_first) std::swap(scene[0], scene[1]);
    Renderer renderer(scene, kKinect);
    const RenderedImage& image = renderer.render(Eigen::Isometry3d::Identity());
    EXPECT_EQ(image.surface[100 * 640 + 319], 2);
    EXPECT_EQ(image.surface[100 * 640 + 320], 1);
  }
}

TEST(Renderer, RefusesIntrinsicsOfNoCamera) {
  EXPECT_THROW(Renderer({}, {640, 480, 0.0, 585.0, 320.0, 240.0}), std::invalid_argument);
  EXPECT_THROW(Renderer({}, {0, 480, 585.0, 585.0, 320.0, 240.0}), std::invalid_argument);
}

TEST(Renderer, AgreesWithARayCasterOnAnApartment) {
  SimulationConfig config;
  config.seed = 21;
  config.frames = 12;
  config.intrinsics = {160, 120, 146.25, 146.25, 80.0, 60.0};
  SimulatedSource source(config);
  std::size_t compared = 0;
  while (source.next()) {
    const Eigen::Isometry3d& pose = source.true_T_world_sensor();
    for (int v = 0; v < 120; ++v) {
      for (int u = 0; u < 160; ++u) {
        const std::size_t at = static_cast<std::size_t>(v) * 160 + u;
        const Hit hit = cast_ray(source.truth(), pose.translation(),
                                 pose.linear() * ray_through(config.intrinsics, u, v), /*both_sides=*/false);
        ASSERT_NE(hit.surface, kNoSurface) << "the apartment has a hole";
        ASSERT_NEAR(source.true_depth_m()[at] / hit.along, 1.0, 1e-5) << u << " " << v << " " << hit.surface;
        // At the edge between two surfaces both are right.
        const SurfaceId seen = source.label_image()[at];
        const Surface& surface = source.truth().at(seen - 1u);
        const Eigen::Vector3d p_m =
            pose.translation() + hit.along * (pose.linear() * ray_through(config.intrinsics, u, v));
        ASSERT_TRUE(seen == hit.surface || std::abs(surface.plane.signed_distance_m(p_m)) < 1e-5) << u << " " << v;
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 12u * 160u * 120u);
}

/// What an ideal camera sees of a wall at one depth, at one angle of incidence everywhere.
RenderedImage flat_image(float depth_m, double incidence_rad) {
  const std::size_t pixels = 640u * 480u;
  return {std::vector<float>(pixels, depth_m), std::vector<SurfaceId>(pixels, 1),
          std::vector<float>(pixels, static_cast<float>(std::cos(incidence_rad)))};
}

double lost_share(const std::vector<std::uint16_t>& depth) {
  return static_cast<double>(std::count(depth.begin(), depth.end(), kNoReturn)) / static_cast<double>(depth.size());
}

TEST(KinectSensor, NoiseGrowsWithTheSquareOfDepthAsModelled) {
  const KinectSensor sensor({}, kKinect);
  for (const double centre_m : {1.0, 2.0, 4.0}) {
    // Disparities over 32 whole steps: at a single one, rounding to steps and millimetres is no noise but a shift.
    constexpr double kDisparityPxM = 585.0 * 0.075;
    RenderedImage image = flat_image(0.0F, 0.0);
    for (std::size_t at = 0; at < image.depth_m.size(); ++at) {
      const double offset_px = 4.0 * (static_cast<double>(at % 9973) / 9973.0 - 0.5);
      image.depth_m[at] = static_cast<float>(kDisparityPxM / (kDisparityPxM / centre_m + offset_px));
    }
    double squares = 0.0;  // of the errors in standard deviations of the model
    double sum_m = 0.0;    // of the errors
    double bias_m = 0.0;   // expected: depth from a disparity with errors is too large by sigma^2 / z
    double count = 0.0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto depth = sensor.measure(image, seed);
      for (std::size_t at = 0; at < depth.size(); ++at) {
        const double z_m = static_cast<double>(image.depth_m[at]);
        const double step_m = z_m * z_m * 0.125 / kDisparityPxM;
        const double sigma_m = std::sqrt(std::pow(1.425e-3 * z_m * z_m, 2) + step_m * step_m / 12.0 + 1e-6 / 12.0);
        const double error_m = 1e-3 * depth[at] - z_m;
        squares += std::pow(error_m / sigma_m, 2);
        sum_m += error_m;
        bias_m += sigma_m * sigma_m / z_m;
      }
      count += static_cast<double>(depth.size());
    }
    EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.01) << centre_m;
    // Rounded to millimetres, 32 steps are off by 0.05 mm on average.
    EXPECT_NEAR(sum_m / count, bias_m / count, 1.2e-4) << centre_m;
  }
}

TEST(KinectSensor, ReportsStepsOfDisparityOnly) {
  const auto depth = KinectSensor({}, kKinect).measure(flat_image(3.0F, 0.0), 1);
  for (const std::uint16_t value : depth) {
    const double steps = 8.0 * 585.0 * 0.075 / (1e-3 * value);
    // Half a millimetre of rounding is 0.02 steps at 3 m.
    ASSERT_NEAR(steps, std::round(steps), 0.03) << value;
  }
}

TEST(KinectSensor, LosesReturnsAtGrazingAngles) {
  const KinectSensor sensor({}, kKinect);
  const double deg = 0.017453292519943295;
  EXPECT_EQ(lost_share(sensor.measure(flat_image(2.0F, 74.0 * deg), 1)), 0.0);
  EXPECT_NEAR(lost_share(sensor.measure(flat_image(2.0F, 80.0 * deg), 2)), 0.5, 0.01);
  EXPECT_EQ(lost_share(sensor.measure(flat_image(2.0F, 86.0 * deg), 3)), 1.0);
}

TEST(KinectSensor, LosesReturnsOutsideItsRange) {
  const KinectSensor sensor({}, kKinect);
  EXPECT_EQ(lost_share(sensor.measure(flat_image(0.4F, 0.0), 1)), 1.0);
  EXPECT_EQ(lost_share(sensor.measure(flat_image(0.5F, 0.0), 1)), 0.0);
  EXPECT_EQ(lost_share(sensor.measure(flat_image(5.5F, 0.0), 1)), 0.0);
  EXPECT_EQ(lost_share(sensor.measure(flat_image(7.0F, 0.0), 1)), 1.0);
}

TEST(KinectSensor, LosesHalfOfTheReturnsBesideAStepInDepth) {
  RenderedImage image = flat_image(1.0F, 0.0);
  for (std::size_t at = 0; at < image.depth_m.size(); ++at) {
    if (at % 640 < 320) continue;
    image.depth_m[at] = 3.0F;
    image.surface[at] = 2;
  }
  const auto depth = KinectSensor({}, kKinect).measure(image, 9);
  int lost_beside = 0;
  for (std::size_t at = 0; at < depth.size(); ++at) {
    const bool beside = at % 640 == 319 || at % 640 == 320;
    if (beside && depth[at] == kNoReturn) ++lost_beside;
    if (!beside) {
      ASSERT_NE(depth[at], kNoReturn) << at;
    }
  }
  EXPECT_NEAR(lost_beside / 960.0, 0.5, 0.07);
}

TEST(KinectSensor, IsExactToTheMillimetreWithoutNoise) {
  DepthNoiseConfig config;
  config.scale = 0.0;
  for (const std::uint16_t value : KinectSensor(config, kKinect).measure(flat_image(3.2104F, 1.45), 1)) {
    ASSERT_EQ(value, 3210);
  }
}

TEST(KinectSensor, RefusesSettingsThatMeanNothing) {
  const auto refuses = [](auto change) {
    DepthNoiseConfig config;
    change(config);
    EXPECT_THROW(KinectSensor(config, kKinect), std::invalid_argument);
  };
  refuses([](DepthNoiseConfig& c) { c.scale = -1.0; });
  refuses([](DepthNoiseConfig& c) { c.baseline_m = 0.0; });
  refuses([](DepthNoiseConfig& c) { c.border_loss = 1.5; });
  refuses([](DepthNoiseConfig& c) { c.max_range_m = 70.0; });
  refuses([](DepthNoiseConfig& c) { c.min_range_m = c.max_range_m; });
}

}  // namespace
}  // namespace planemap::simulation

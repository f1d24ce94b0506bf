#include "coverage.hpp"

#include <algorithm>
#include <planemap/simulation/renderer.hpp>

namespace planemap::simulation {
namespace {

constexpr int kFrames = 150;
constexpr PinholeIntrinsics kCamera{80, 60, 73.125, 73.125, 39.5, 29.5};  // the Kinect's, eight times coarser
constexpr float kNearM = 0.5F;
constexpr float kFarM = 4.5F;
constexpr float kLeastCosine = 0.26F;  // 75 degrees
constexpr double kLeastShare = 1.0;    // of a surface's area, summed over the frames

}  // namespace

std::vector<Surface> poorly_seen(const Tour& tour, const Apartment& apartment, const std::vector<Surface>& surfaces) {
  Renderer renderer(surfaces, kCamera);
  std::vector<double> seen_m2(surfaces.size() + 1, 0.0);
  for (int k = 0; k < kFrames; ++k) {
    const double time_s = tour.duration_s() * k / kFrames;
    const RenderedImage& image = renderer.render(apartment.T_world_apartment * tour.T_scene_sensor(time_s));
    for (std::size_t i = 0; i < image.surface.size(); ++i) {
      const float depth_m = image.depth_m[i];
      if (image.cos_incidence[i] < kLeastCosine || depth_m < kNearM || depth_m > kFarM) continue;
      seen_m2[image.surface[i]] +=
          static_cast<double>(depth_m * depth_m / image.cos_incidence[i]) / (kCamera.fx * kCamera.fy);
    }
  }
  std::vector<Surface> poor;
  for (const Surface& surface : surfaces) {
    const double whole_m2 = area_m2(surface);
    if (whole_m2 > kLargeSurfaceM2 && seen_m2[surface.id] < kLeastShare * whole_m2) poor.push_back(surface);
  }
  return poor;
}

}  // namespace planemap::simulation

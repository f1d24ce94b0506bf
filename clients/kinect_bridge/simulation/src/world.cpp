#include "world.hpp"

#include <algorithm>
#include <planemap/simulation/scenes.hpp>
#include <utility>

#include "random.hpp"
#include "scene.hpp"

namespace planemap::simulation {
namespace {

constexpr std::uint64_t kLayoutStream = 1;  // of the seed; others are of the noise

/// A scene, and the camera's round through it.
class RoundTrip final : public World {
 public:
  RoundTrip(const SimulationConfig& config, Scene scene)
      : scene_(std::move(scene)),
        frames_(config.frames.value_or(scene_.frames.value_or(std::max<std::size_t>(
            1, static_cast<std::size_t>(scene_.tour.duration_s() * config.rate_hz / config.time_lapse))))) {}

  Eigen::Isometry3d T_world_sensor(std::size_t index) override {
    const double time_s =
        static_cast<double>(index % frames_) / static_cast<double>(frames_) * scene_.tour.duration_s();
    return scene_.T_world_scene * scene_.tour.T_scene_sensor(time_s);
  }
  const RenderedImage& look(Renderer& renderer, const Eigen::Isometry3d& T_world_sensor) override {
    if (!std::exchange(is_shown_, true)) renderer.show(scene_.surfaces);
    return renderer.render(T_world_sensor);
  }
  const std::vector<Surface>& truth() override { return scene_.surfaces; }
  Eigen::Vector3d down() const override { return scene_.T_world_scene.linear() * -Eigen::Vector3d::UnitZ(); }
  double tour_s() const override { return scene_.tour.duration_s(); }
  std::size_t frames() const override { return frames_; }

 private:
  Scene scene_;
  std::size_t frames_;
  bool is_shown_ = false;
};

}  // namespace

std::unique_ptr<World> make_world(const SimulationConfig& config) {
  if (config.scene == kBuildingScene) return make_building_world(config);
  Random random(config.seed, kLayoutStream);
  return std::make_unique<RoundTrip>(config, make_scene(config.scene, random));
}

}  // namespace planemap::simulation

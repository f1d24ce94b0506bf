#include <utility>

#include "../world.hpp"
#include "building.hpp"

namespace planemap::simulation {
namespace {

constexpr std::size_t kFrames = 20'000;  // unless told otherwise
constexpr double kCornerM = 1.25;        // to the corner of a Kinect's image, for each metre of depth
constexpr double kMarginM = 0.5;         // by which noise may bring what is out of range into it

class BuildingWorld final : public World {
 public:
  explicit BuildingWorld(const SimulationConfig& config)
      : farthest_m_(static_cast<float>(config.depth_noise.max_range_m + kMarginM)),
        building_(config.seed, kCornerM * (config.depth_noise.max_range_m + kMarginM)),
        frames_(config.frames.value_or(kFrames)),
        step_s_(config.time_lapse / config.rate_hz) {}

  Eigen::Isometry3d T_world_sensor(std::size_t index) override {
    return building_.T_world_sensor(static_cast<double>(index) * step_s_);
  }
  const RenderedImage& look(Renderer& renderer, const Eigen::Isometry3d& T_world_sensor) override {
    if (const auto near = building_.look_from(T_world_sensor.translation())) renderer.show(*near);
    image_ = renderer.render(T_world_sensor);
    for (std::size_t i = 0; i < image_.depth_m.size(); ++i) {
      if (image_.depth_m[i] <= farthest_m_) continue;  // farther away things may be missing
      image_.depth_m[i] = image_.cos_incidence[i] = 0.0F;
      image_.surface[i] = kNoSurface;
    }
    building_.name(image_.surface);
    return image_;
  }
  const std::vector<Surface>& truth() override {
    truth_ = building_.seen();
    return truth_;
  }
  Eigen::Vector3d down() const override { return building_.T_world_building().linear() * -Eigen::Vector3d::UnitZ(); }
  double tour_s() const override { return static_cast<double>(frames_) * step_s_; }
  std::size_t frames() const override { return frames_; }

 private:
  float farthest_m_;
  Building building_;
  std::size_t frames_;
  double step_s_;
  RenderedImage image_;
  std::vector<Surface> truth_;
};

}  // namespace

std::unique_ptr<World> make_building_world(const SimulationConfig& config) {
  return std::make_unique<BuildingWorld>(config);
}

}  // namespace planemap::simulation

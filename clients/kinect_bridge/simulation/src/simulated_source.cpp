#include <algorithm>
#include <cmath>
#include <planemap/simulation/renderer.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <stdexcept>
#include <utility>

#include "pose_noise.hpp"
#include "random.hpp"
#include "scene.hpp"

namespace planemap::simulation {
namespace {

// Streams of the seed, so that one part of the simulation does not change another.
enum Stream : std::uint64_t { kLayoutStream = 1, kPoseStream = 2, kDepthStream = 3 };

Scene scene_of(const SimulationConfig& config) {
  Random random(config.seed, kLayoutStream);
  return make_scene(config.scene, random);
}

const SimulationConfig& checked(const SimulationConfig& config) {
  if (!std::isfinite(config.rate_hz) || config.rate_hz <= 0.0) {
    throw std::invalid_argument("SimulationConfig: rate_hz must be > 0");
  }
  if (config.frames == std::size_t{0}) throw std::invalid_argument("SimulationConfig: frames must be > 0");
  return config;
}

}  // namespace

class SimulatedSource::Impl {
 public:
  explicit Impl(const SimulationConfig& wanted)
      : config(checked(wanted)),
        scene(scene_of(config)),
        renderer(scene.surfaces, config.intrinsics),
        sensor(config.depth_noise, config.intrinsics),
        pose_noise(config.pose_noise, Random(config.seed, kPoseStream)),
        frames_a_tour(config.frames.value_or(scene.frames.value_or(
            std::max<std::size_t>(1, static_cast<std::size_t>(scene.tour.duration_s() * config.rate_hz))))) {}

  sources::Frame next_frame() {
    const double tour_time_s =
        static_cast<double>(index % frames_a_tour) / static_cast<double>(frames_a_tour) * scene.tour.duration_s();
    T_world_sensor = scene.T_world_scene * scene.tour.T_scene_sensor(tour_time_s);
    rendered = &renderer.render(T_world_sensor);
    sources::Frame frame;
    frame.scan.utime = kFirstUtime + std::llround(static_cast<double>(index) / config.rate_hz * 1e6);
    frame.scan.intrinsics = config.intrinsics;
    frame.scan.depth_scale_m = 0.001;
    frame.scan.depth = sensor.measure(*rendered, Random(config.seed, kDepthStream + (index << 8U)).bits());
    frame.T_world_sensor = pose_noise.disturb(T_world_sensor, 1.0 / config.rate_hz);
    ++index;
    return frame;
  }

  SimulationConfig config;
  Scene scene;
  Renderer renderer;
  KinectSensor sensor;
  PoseNoise pose_noise;
  std::size_t frames_a_tour;
  std::map<std::string, std::size_t> skipped;

  std::size_t index = 0;  // of the next frame
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
  const RenderedImage* rendered = nullptr;
};

SimulatedSource::SimulatedSource(const SimulationConfig& config) : impl_(std::make_unique<Impl>(config)) {}
SimulatedSource::~SimulatedSource() = default;

std::optional<sources::Frame> SimulatedSource::next() {
  if (!impl_->config.loop && impl_->index == impl_->frames_a_tour) return std::nullopt;
  return impl_->next_frame();
}

std::optional<std::size_t> SimulatedSource::size() const {
  if (impl_->config.loop) return std::nullopt;
  return impl_->frames_a_tour;
}

const std::map<std::string, std::size_t>& SimulatedSource::skipped() const {
  return impl_->skipped;
}

std::optional<Eigen::Vector3d> SimulatedSource::gravity_direction() const {
  return Eigen::Vector3d(impl_->scene.T_world_scene.linear() * -Eigen::Vector3d::UnitZ());
}

const std::vector<Surface>& SimulatedSource::truth() const {
  return impl_->scene.surfaces;
}
double SimulatedSource::tour_s() const {
  return impl_->scene.tour.duration_s();
}

std::span<const SurfaceId> SimulatedSource::label_image() const {
  if (impl_->rendered == nullptr) return {};
  return impl_->rendered->surface;
}

std::span<const float> SimulatedSource::true_depth_m() const {
  if (impl_->rendered == nullptr) return {};
  return impl_->rendered->depth_m;
}

const Eigen::Isometry3d& SimulatedSource::true_T_world_sensor() const {
  return impl_->T_world_sensor;
}

}  // namespace planemap::simulation

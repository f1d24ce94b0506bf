#include <cmath>
#include <planemap/simulation/renderer.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <stdexcept>
#include <utility>

#include "pose_noise.hpp"
#include "random.hpp"
#include "world.hpp"

namespace planemap::simulation {
namespace {

// Streams of the seed, so that one part of the simulation does not change another.
enum Stream : std::uint64_t { kPoseStream = 2, kDepthStream = 3 };

const SimulationConfig& checked(const SimulationConfig& config) {
  if (!std::isfinite(config.rate_hz) || config.rate_hz <= 0.0) {
    throw std::invalid_argument("SimulationConfig: rate_hz must be > 0");
  }
  if (!std::isfinite(config.time_lapse) || config.time_lapse <= 0.0) {
    throw std::invalid_argument("SimulationConfig: time_lapse must be > 0");
  }
  if (config.frames == std::size_t{0}) throw std::invalid_argument("SimulationConfig: frames must be > 0");
  return config;
}

}  // namespace

class SimulatedSource::Impl {
 public:
  explicit Impl(const SimulationConfig& wanted)
      : config(checked(wanted)),
        world(make_world(config)),
        renderer({}, config.intrinsics),
        sensor(config.depth_noise, config.intrinsics),
        pose_noise(config.pose_noise, Random(config.seed, kPoseStream)) {}

  sources::Frame next_frame() {
    T_world_sensor = world->T_world_sensor(index);
    rendered = &world->look(renderer, T_world_sensor);
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
  std::unique_ptr<World> world;
  Renderer renderer;
  KinectSensor sensor;
  PoseNoise pose_noise;
  std::map<std::string, std::size_t> skipped;

  std::size_t index = 0;  // of the next frame
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
  const RenderedImage* rendered = nullptr;
};

SimulatedSource::SimulatedSource(const SimulationConfig& config) : impl_(std::make_unique<Impl>(config)) {}
SimulatedSource::~SimulatedSource() = default;

std::optional<sources::Frame> SimulatedSource::next() {
  if (!impl_->config.loop && impl_->index == impl_->world->frames()) return std::nullopt;
  return impl_->next_frame();
}

std::optional<std::size_t> SimulatedSource::size() const {
  if (impl_->config.loop) return std::nullopt;
  return impl_->world->frames();
}

const std::map<std::string, std::size_t>& SimulatedSource::skipped() const {
  return impl_->skipped;
}

std::optional<Eigen::Vector3d> SimulatedSource::gravity_direction() const {
  return impl_->world->down();
}

const std::vector<Surface>& SimulatedSource::truth() const {
  return impl_->world->truth();
}
double SimulatedSource::tour_s() const {
  return impl_->world->tour_s();
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

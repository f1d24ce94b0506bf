#include <algorithm>
#include <cmath>
#include <planemap/simulation/renderer.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <stdexcept>
#include <utility>

#include "apartment.hpp"
#include "coverage.hpp"
#include "pose_noise.hpp"
#include "random.hpp"
#include "tour.hpp"

namespace planemap::simulation {
namespace {

constexpr int kMaxTries = 1000;

// Streams of the seed, so that one part of the simulation does not change another.
enum Stream : std::uint64_t { kLayoutStream = 1, kPoseStream = 2, kDepthStream = 3 };

struct World {
  Apartment apartment;
  std::vector<Surface> surfaces;
  Tour tour;
};

/// Where to look at a surface: its largest piece.
View view_of(const Surface& surface, const Eigen::Isometry3d& T_apartment_world) {
  const auto largest =
      std::max_element(surface.pieces_m.begin(), surface.pieces_m.end(),
                       [](const ConvexPiece& a, const ConvexPiece& b) { return area_m2(a) < area_m2(b); });
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner_m : *largest) middle_m += corner_m / static_cast<double>(largest->size());
  return {T_apartment_world * middle_m, T_apartment_world.linear() * surface.plane.normal()};
}

/// A tour that shows every large surface: what the plain one misses, the robot goes and looks at. Empty if there is
/// none.
std::optional<Tour> plan_tour(const Apartment& apartment, const std::vector<Surface>& surfaces) {
  constexpr int kRounds = 4;  // a longer tour is recorded in larger steps, and may miss something else
  const Eigen::Isometry3d T_apartment_world = apartment.T_world_apartment.inverse();
  std::vector<View> views;
  for (int round = 0; round < kRounds; ++round) {
    auto tour = Tour::plan(apartment, views);
    if (!tour) return std::nullopt;
    const std::vector<Surface> missed = poorly_seen(*tour, apartment, surfaces);
    if (missed.empty()) return tour;
    for (const Surface& surface : missed) views.push_back(view_of(surface, T_apartment_world));
  }
  return std::nullopt;
}

/// The first apartment of a seed's that a robot can drive through and see.
World make_world(std::uint64_t seed) {
  Random random(seed, kLayoutStream);
  for (int attempt = 0; attempt < kMaxTries; ++attempt) {
    Apartment apartment = make_apartment(random);
    std::vector<Surface> surfaces = make_surfaces(apartment);
    if (auto tour = plan_tour(apartment, surfaces)) {
      return {std::move(apartment), std::move(surfaces), std::move(*tour)};
    }
  }
  throw std::runtime_error("SimulatedSource: no apartment that a robot can drive through and see in 1000 tries");
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
        world(make_world(config.seed)),
        renderer(world.surfaces, config.intrinsics),
        sensor(config.depth_noise, config.intrinsics),
        pose_noise(config.pose_noise, Random(config.seed, kPoseStream)),
        frames_a_tour(config.frames.value_or(
            std::max<std::size_t>(1, static_cast<std::size_t>(world.tour.duration_s() * config.rate_hz)))) {}

  sources::Frame next_frame() {
    const double tour_time_s =
        static_cast<double>(index % frames_a_tour) / static_cast<double>(frames_a_tour) * world.tour.duration_s();
    T_world_sensor = world.apartment.T_world_apartment * world.tour.T_apartment_sensor(tour_time_s);
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
  World world;
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
  return Eigen::Vector3d(impl_->world.apartment.T_world_apartment.linear() * -Eigen::Vector3d::UnitZ());
}

const std::vector<Surface>& SimulatedSource::truth() const {
  return impl_->world.surfaces;
}
double SimulatedSource::tour_s() const {
  return impl_->world.tour.duration_s();
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

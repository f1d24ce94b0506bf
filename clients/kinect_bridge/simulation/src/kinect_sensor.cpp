#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <planemap/simulation/kinect_sensor.hpp>
#include <stdexcept>
#include <string>

#include "random.hpp"

namespace planemap::simulation {
namespace {

constexpr double kMostDisparityPx = 4096.0;  // an image is no wider
constexpr double kStepM = 0.05;              // of depth between neighbouring pixels, which makes a border
constexpr std::size_t kQuantiles = 4096;

/// A normal variable at equally probable places, scaled to variance 1: twelve random bits pick one. Ten times faster
/// than making one of logarithm and cosine; its tails end at 3.7 sigma.
std::vector<float> normal_quantiles() {
  const boost::math::normal_distribution<double> normal;
  std::vector<double> values(kQuantiles);
  double sum_of_squares = 0.0;
  for (std::size_t i = 0; i < kQuantiles; ++i) {
    values[i] = boost::math::quantile(normal, (static_cast<double>(i) + 0.5) / kQuantiles);
    sum_of_squares += values[i] * values[i];
  }
  std::vector<float> scaled;
  scaled.reserve(kQuantiles);
  for (const double value : values)
    scaled.push_back(static_cast<float>(value / std::sqrt(sum_of_squares / kQuantiles)));
  return scaled;
}

/// The k-th 16 of 64 random bits, as a number in [0, 1).
float share_of(std::uint64_t bits, unsigned k) {
  return static_cast<float>((bits >> (16U * k)) & 0xffffU) * 0x1.0p-16F;
}

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("DepthNoiseConfig: ") + what);
}

}  // namespace

KinectSensor::KinectSensor(const DepthNoiseConfig& config, const PinholeIntrinsics& intrinsics)
    : config_(config),
      intrinsics_(intrinsics),
      disparity_px_m_(intrinsics.fx * config.baseline_m),
      disparity_sigma_px_(disparity_px_m_ * config.depth_sigma_per_m * config.scale),
      quantiles_(normal_quantiles()) {
  const auto at_least_zero = [](double value) { return std::isfinite(value) && value >= 0.0; };
  require(at_least_zero(config.scale), "scale must be >= 0");
  require(at_least_zero(config.depth_sigma_per_m), "depth_sigma_per_m must be >= 0");
  require(std::isfinite(config.baseline_m) && config.baseline_m > 0.0, "baseline_m must be > 0");
  require(at_least_zero(config.disparity_step_px), "disparity_step_px must be >= 0");
  require(at_least_zero(config.grazing_begin_rad) && config.grazing_begin_rad < config.grazing_end_rad,
          "grazing_begin_rad must be >= 0 and less than grazing_end_rad");
  require(config.border_loss >= 0.0 && config.border_loss <= 1.0, "border_loss must be in 0 to 1");
  require(at_least_zero(config.min_range_m) && config.min_range_m < config.max_range_m,
          "min_range_m must be >= 0 and less than max_range_m");
  require(config.max_range_m < 65.0, "max_range_m must be less than 65, which 16 bits of millimetres hold");
  if (config.scale == 0.0 || config.disparity_step_px == 0.0) return;
  const double most_px = config.min_range_m > 0.0 ? disparity_px_m_ / config.min_range_m : kMostDisparityPx;
  const auto steps = static_cast<std::size_t>(std::ceil(most_px / config.disparity_step_px)) + 1;
  millimetres_of_step_.reserve(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    millimetres_of_step_.push_back(to_millimetres(static_cast<double>(i) * config.disparity_step_px));
  }
}

double KinectSensor::lost_share(float cos_incidence) const {
  const double incidence_rad = std::acos(static_cast<double>(cos_incidence));
  return std::clamp((incidence_rad - config_.grazing_begin_rad) / (config_.grazing_end_rad - config_.grazing_begin_rad),
                    0.0, 1.0);
}

bool KinectSensor::beside_step(const RenderedImage& image, int u, int v) const {
  const std::size_t at = static_cast<std::size_t>(v) * intrinsics_.width + u;
  const auto steps_to = [&image, at](std::size_t neighbour) {
    return image.surface[neighbour] != image.surface[at] &&
           std::abs(image.depth_m[neighbour] - image.depth_m[at]) > static_cast<float>(kStepM);
  };
  return (u > 0 && steps_to(at - 1)) || (u + 1 < intrinsics_.width && steps_to(at + 1)) ||
         (v > 0 && steps_to(at - intrinsics_.width)) ||
         (v + 1 < intrinsics_.height && steps_to(at + intrinsics_.width));
}

std::uint16_t KinectSensor::to_millimetres(double disparity_px) const {
  if (disparity_px <= 0.0) return kNoReturn;
  const double depth_m = disparity_px_m_ / disparity_px;
  if (depth_m < config_.min_range_m || depth_m > config_.max_range_m) return kNoReturn;
  return static_cast<std::uint16_t>(std::lround(depth_m * 1000.0));
}

std::vector<std::uint16_t> KinectSensor::measure(const RenderedImage& image, std::uint64_t seed) const {
  std::vector<std::uint16_t> depth(image.depth_m.size(), kNoReturn);
  const std::uint64_t start = mix(seed);  // successive seeds start far from each other
  const bool loses_returns = config_.scale > 0.0;
  const bool quantised = !millimetres_of_step_.empty();
  const auto grazing_cos = static_cast<float>(std::cos(config_.grazing_begin_rad));
  const auto border_loss = static_cast<float>(config_.border_loss);
  const auto sigma_px = static_cast<float>(disparity_sigma_px_);
  const auto steps_per_px = quantised ? static_cast<float>(1.0 / config_.disparity_step_px) : 1.0F;
  const auto disparity_px_m = static_cast<float>(disparity_px_m_);
  for (int v = 0; v < intrinsics_.height; ++v) {
    for (int u = 0; u < intrinsics_.width; ++u) {
      const std::size_t at = static_cast<std::size_t>(v) * intrinsics_.width + u;
      if (image.surface[at] == kNoSurface) continue;
      const std::uint64_t bits = mix(start + at);  // a number for each pixel: the order does not matter
      if (loses_returns) {
        const float cos_incidence = image.cos_incidence[at];
        if (cos_incidence < grazing_cos && share_of(bits, 1) < lost_share(cos_incidence)) continue;
        if (beside_step(image, u, v) && share_of(bits, 2) < border_loss) continue;
      }
      if (!quantised) {
        const double noise_px = disparity_sigma_px_ * static_cast<double>(quantiles_[bits % kQuantiles]);
        depth[at] = to_millimetres(disparity_px_m_ / static_cast<double>(image.depth_m[at]) + noise_px);
        continue;
      }
      const float disparity_px = disparity_px_m / image.depth_m[at] + sigma_px * quantiles_[bits % kQuantiles];
      const auto step = static_cast<std::int32_t>(std::lround(disparity_px * steps_per_px));
      if (step > 0 && step < static_cast<std::int32_t>(millimetres_of_step_.size()))
        depth[at] = millimetres_of_step_[step];
    }
  }
  return depth;
}

}  // namespace planemap::simulation

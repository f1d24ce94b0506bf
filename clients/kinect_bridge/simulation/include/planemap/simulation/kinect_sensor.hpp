#pragma once

#include <cstdint>
#include <planemap/scan.hpp>
#include <planemap/simulation/renderer.hpp>
#include <vector>

namespace planemap::simulation {

/// Errors of the simulated Kinect: Khoshelham and Elberink, Sensors 12(2), 2012.
struct DepthNoiseConfig {
  double scale = 1.0;                   ///< times the random error; 0: exact depth, no quantisation, no lost returns
  double depth_sigma_per_m = 1.425e-3;  ///< k in sigma_z = k z^2 (1/m)
  double baseline_m = 0.075;
  double disparity_step_px = 0.125;  ///< 0: not quantised
  double grazing_begin_rad = 1.309;  ///< incidence from which returns get lost (75 degrees) ...
  double grazing_end_rad = 1.484;    ///< ... and beyond which there are none (85 degrees)
  double border_loss = 0.5;          ///< share of returns lost beside a step in depth
  double min_range_m = 0.45;         ///< no returns from nearer
  double max_range_m = 6.0;          ///< no returns from farther
};

/// Makes of what an ideal camera sees what a Kinect reports. The disparity f b / z gets Gaussian noise, so that depth
/// has sigma_z = k z^2, and is rounded to its step; depth is rounded to millimetres.
class KinectSensor {
 public:
  /// Throws std::invalid_argument if a setting is out of its range.
  KinectSensor(const DepthNoiseConfig& config, const PinholeIntrinsics& intrinsics);

  /// Millimetres, row-major; kNoReturn where nothing comes back. The same image and seed give the same depth.
  std::vector<std::uint16_t> measure(const RenderedImage& image, std::uint64_t seed) const;

 private:
  double lost_share(float cos_incidence) const;
  bool beside_step(const RenderedImage& image, int u, int v) const;
  std::uint16_t to_millimetres(double disparity_px) const;

  DepthNoiseConfig config_;
  PinholeIntrinsics intrinsics_;
  double disparity_px_m_;                           // disparity times depth: f b
  double disparity_sigma_px_;                       // from k and the scale; the same at every depth
  std::vector<float> quantiles_;                    // of the normal distribution
  std::vector<std::uint16_t> millimetres_of_step_;  // depth for each step of the disparity; empty: not quantised
};

}  // namespace planemap::simulation
